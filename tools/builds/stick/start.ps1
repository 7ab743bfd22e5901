# Installs tsc from this stick, where a computer has Python, and makes it a command of this window:
#     Set-ExecutionPolicy -Scope Process Bypass;  . .\start.ps1
$python = @("py", "python") | Where-Object { Get-Command $_ -ErrorAction SilentlyContinue } |
    Where-Object { & $_ -c "import sys; sys.exit(sys.version_info < (3, 10))" 2>$null; $LASTEXITCODE -eq 0 } |
    Select-Object -First 1
if (-not $python) {
    Write-Host "Python 3.10 or newer is missing: start.bat installs it. Falta Python: lo instala start.bat. Falta o Python: start.bat o instala."
} else {
    & $python (Join-Path $PSScriptRoot "install.py")
    if ($LASTEXITCODE -eq 0) { . (Join-Path $HOME "TiniScript\tsc\Scripts\Activate.ps1") }
}

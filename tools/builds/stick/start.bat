@echo off
rem Installs tsc from this stick, and opens a window in which it works. Asks for no administrator.
setlocal
set "HERE=%~dp0"
set "SETUP="
set "PY=py -3"
%PY% -c "import sys; sys.exit(sys.version_info < (3, 10))" >nul 2>nul && goto found
set "PY=python"
%PY% -c "import sys; sys.exit(sys.version_info < (3, 10))" >nul 2>nul && goto found
for %%I in ("%HERE%python-3*-amd64.exe") do set "SETUP=%%~fI"
if not defined SETUP goto nothing
echo Installing Python / Instalando Python ...
start "" /wait "%SETUP%" /passive InstallAllUsers=0 PrependPath=1 Include_launcher=1 InstallLauncherAllUsers=0
set "PY="
rem An older Python may lie beside the new one, and its name comes later: Python39 after Python313.
for /d %%I in ("%LocalAppData%\Programs\Python\Python3*") do "%%~fI\python.exe" -c "import sys; sys.exit(sys.version_info < (3, 10))" >nul 2>nul && set "PY="%%~fI\python.exe""
if not defined PY goto nothing
:found
%PY% "%HERE%install.py"
if errorlevel 1 goto failed
start "" "%USERPROFILE%\TiniScript\pages\index.html"
cd /d "%USERPROFILE%\TiniScript"
rem cmd takes the first and the last quotation mark away, and the path may have spaces.
cmd /k ""%USERPROFILE%\TiniScript\tsc\Scripts\activate.bat""
goto :eof
:nothing
echo Python 3.10 or newer is missing, and this stick has no installer: python.org
echo Falta Python 3.10 o mas nuevo, y esta memoria no trae su instalador: python.org
echo Falta o Python 3.10 ou mais novo, e este pen drive nao traz o instalador: python.org
:failed
pause

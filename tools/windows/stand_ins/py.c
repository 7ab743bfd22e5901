// The launcher `py` that python.org's installer brings: without its own options but -3.
#include <wchar.h>
#include <windows.h>

int main(void) {
  static wchar_t line[32768];
  const wchar_t* rest = GetCommandLineW();
  int is_quoted = 0;
  while (*rest && (is_quoted || *rest != L' ')) is_quoted ^= *rest++ == L'"';
  while (*rest == L' ') ++rest;
  if (wcsncmp(rest, L"-3", 2) == 0 && (rest[2] == L' ' || !rest[2])) rest += 2;
  wcscpy(line, L"python.exe ");
  wcsncat(line, rest, 32000);
  STARTUPINFOW begin = {.cb = sizeof begin};
  PROCESS_INFORMATION made;
  if (!CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &begin, &made)) return 103;
  DWORD code = 1;
  WaitForSingleObject(made.hProcess, INFINITE);
  GetExitCodeProcess(made.hProcess, &code);
  return (int)code;
}

// What wine 8 lacks of Windows: a function that pyserial asks for when it lists ports. The others
// that it asks for are in setupapi: cfgmgr32.def.
__declspec(dllexport) unsigned long __stdcall CM_MapCrToWin32Err(unsigned long code,
                                                                 unsigned long otherwise) {
  return code == 0 ? 0 : otherwise;
}

// Stands in for a library of Windows that Wine lacks before its release 9: Rust's standard library asks it for random
// bytes. For tests only.
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count) {
    return RtlGenRandom(bytes, (ULONG)count);
}

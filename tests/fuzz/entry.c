/* entry.c: libFuzzer's way in; TARGET is one of target.h. */
#include "fuzz/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return TARGET(bytes, size);
}

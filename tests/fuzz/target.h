/* target.h: what is fed with bytes of any kind; none may crash, hang, leak or
 * touch a file. */
#ifndef RTC_FUZZ_TARGET_H
#define RTC_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

int fuzz_parse(const uint8_t *bytes, size_t size);     /* text -> tokens -> AST, and its dump */
int fuzz_build(const uint8_t *bytes, size_t size);     /* text -> scene, under small limits */
int fuzz_png(const uint8_t *bytes, size_t size);       /* a picture file */

#endif

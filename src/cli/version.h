/* version.h: what this program is and what it was built with. */
#ifndef RTC_VERSION_H
#define RTC_VERSION_H

#include <stdio.h>

void version_print(FILE *out);

#endif

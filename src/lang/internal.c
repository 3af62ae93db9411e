/* internal.c: the functions that internal(N) stands for. */
#include "lang/code.h"
#include "lang/function.h"

/* Facts sdl.md 5.4: how many parameters each takes, x, y, z among them. */
static const unsigned char parameters[] = {
    8, 8, 8, 8, 5, 5, 8, 7, 5, 4, 7, 4, 4, 4, 4, 9, 9, 6, 4, 7, 6, 9, 4, 4, 13, 10, 10,
    4, 4, 9, 4, 6, 7, 6, 9, 4, 4, 7, 4, 9, 8, 4, 4, 4, 7, 4, 6, 3, 4, 4, 10, 8, 9, 4,
    4, 4, 6, 3, 9, 9, 7, 4, 8, 7, 9, 4, 7, 10, 5, 3, 5, 6, 4, 4, 5, 9, 3, 0, 4,
};

int internal_parameters(int number)
{
    return number >= 0 && number < (int)(sizeof parameters) ? parameters[number] : 0;
}

/* number.h: decimal numbers, in the C locale whatever the user's is. */
#ifndef RTC_NUMBER_H
#define RTC_NUMBER_H

/* Reads digits, point and exponent from p on (a digit or point stands there);
 * returns the place behind. */
char *number_scan(char *p, double *out);

/* The value of the decimal number from begin to end. */
double number_read(const char *begin, const char *end);

/* C's atof in the C locale: the leading number of a text, 0 if none. */
double number_of_text(const char *text);

#endif

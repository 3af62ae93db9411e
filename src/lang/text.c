/* text.c: the functions that take or make texts.
 *
 * Texts are UTF-8; the language counts characters. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lang/call.h"
#include "lang/number.h"

enum { NUMBER_ROOM = 400, FORMAT_MOST = 254, LONGEST_NUMBER = 330 };

/* --- characters ---------------------------------------------------------------- */

static size_t character_size(unsigned char first)
{
    return first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
}

static unsigned character(const char *p, const char *end, size_t *size)
{
    unsigned char c = (unsigned char)*p;

    *size = character_size(c);
    if ((size_t)(end - p) < *size || c < 0xc0) {
        *size = 1;
        return c;
    }
    unsigned code = c & (0xffu >> (*size + 1));
    for (size_t i = 1; i < *size; i++)
        code = code << 6 | ((unsigned char)p[i] & 0x3f);
    return code > 0xffff ? 0xfffd : code;
}

static size_t length(const struct text *t)
{
    size_t n = 0, size;

    for (const char *p = t->bytes, *end = p + t->size; p < end; p += size, n++)
        character(p, end, &size);
    return n;
}

static const char *skip(const struct text *t, size_t n)
{
    const char *p = t->bytes, *end = p + t->size;
    size_t size;

    for (; n && p < end; n--, p += size)
        character(p, end, &size);
    return p;
}

static int difference(const struct text *a, const struct text *b)
{
    const char *p = a->bytes, *q = b->bytes, *p_end = p + a->size, *q_end = q + b->size;

    for (;;) {
        size_t n = 0, m = 0;
        unsigned c = p < p_end ? character(p, p_end, &n) : 0;
        unsigned d = q < q_end ? character(q, q_end, &m) : 0;
        if (c != d || (p >= p_end && q >= q_end))
            return (int)c - (int)d;
        p += n;
        q += m;
    }
}

int text_compare(const struct text *a, const struct text *b)
{
    return difference(a, b);
}

/* What the charset lacks becomes a space, as in POV-Ray. */
struct value text_literal(struct lang *l, const struct ast *a)
{
    bool plain = l->charset_utf8;

    for (size_t i = 0; i < a->size && !plain; i++)
        if ((unsigned char)a->text[i] >= 0x80)
            break;
        else
            plain = i + 1 == a->size;
    if (plain || a->size == 0)
        return (struct value) { .type = VALUE_TEXT, .text = { a->text, a->size } };
    struct value v = value_text(l, a->text, a->size);
    const char *source = source_at(l->sources, a->at.source)->text;
    bool literal = false;
    for (uint32_t i = a->at.begin; i < a->at.end; i++)
        literal = literal || (unsigned char)source[i] >= 0x80;
    if (!literal)
        return v;               /* it came from \u escapes */
    diag_warning(l->diag, a->at,
                 "characters outside of ASCII need global_settings { charset utf8 }");
    char *out = (char *)v.text.bytes;
    for (size_t i = 0; i < a->size; i++)
        if ((unsigned char)a->text[i] >= 0x80)
            out[i] = ' ';
    return v;
}

/* --- making ------------------------------------------------------------------------ */

static struct value text_of(struct arguments *a, const char *bytes, size_t size)
{
    return value_text(a->l, bytes, size);
}

static bool fits(struct arguments *a, size_t size)
{
    if (size <= a->l->limits->string_bytes)
        return true;
    lang_limit(a->l, a->node->at, "a text of more than %zu bytes (--max-string=SIZE would let it be)", a->l->limits->string_bytes);
    return false;
}

void call_concat(struct arguments *a, struct value *out)
{
    size_t size = 0;

    for (int i = 0; i < a->n; i++)
        size += a->v[i].text.size;
    if (!fits(a, size))
        return;
    char *bytes = arena_alloc(a->l->mem, size + 1), *p = bytes;
    for (int i = 0; i < a->n; i++) {
        memcpy(p, a->v[i].text.bytes, a->v[i].text.size);
        p += a->v[i].text.size;
    }
    *out = (struct value) { .type = VALUE_TEXT, .text = { bytes, size } };
}

static int clamp(double x, int least, int most)
{
    return x > least ? x < most ? (int)x : most : least;
}

static int format_number(char *out, size_t size, char letter, int width, int digits, double x)
{
    char format[16];

    snprintf(format, sizeof format, "%%%s*%s%c", width < 0 ? "0" : "", digits < 0 ? "" : ".*",
             letter);
    return digits < 0 ? snprintf(out, size, format, abs(width), x)
        : snprintf(out, size, format, abs(width), digits, x);
}

/* %g when the text would be too long, as POV-Ray's buffer has it, and what it
 * says when that is no help. */
static size_t print_number(char *out, double x, int width, int digits)
{
    int n = format_number(out, NUMBER_ROOM, 'f', width, digits, x);

    if (n < 0 || n > FORMAT_MOST)
        n = format_number(out, NUMBER_ROOM, 'g', width, digits, x);
    if (n < 0 || n > FORMAT_MOST)
        n = snprintf(out, NUMBER_ROOM, "<invalid>");
    return (size_t)n;
}

enum { WIDEST = 1 << 24 };

void call_str(struct arguments *a, struct value *out)
{
    char text[NUMBER_ROOM];
    size_t n = print_number(text, a->v[0].v[0], clamp(a->v[1].v[0], -WIDEST, WIDEST),
                            clamp(a->v[2].v[0], -1, WIDEST));

    *out = text_of(a, text, n);
}

/* Its numbers are as long as they are. */
void call_vstr(struct arguments *a, struct value *out)
{
    int n = clamp(a->v[0].v[0], 2, MOST_COMPONENTS);
    int width = clamp(a->v[3].v[0], -WIDEST, WIDEST), digits = clamp(a->v[4].v[0], -1, WIDEST);
    const struct text *separator = &a->v[2].text;
    const struct value *v = &a->v[1];
    size_t room = (size_t)abs(width) + (size_t)abs(digits) + LONGEST_NUMBER, used = 0;

    if (!fits(a, (size_t)n * (room - LONGEST_NUMBER + separator->size)))
        return;
    char *text = arena_alloc(a->l->mem, (size_t)n * (room + separator->size) + 1);
    for (int i = 0; i < n; i++) {
        memcpy(text + used, separator->bytes, i ? separator->size : 0);
        used += i ? separator->size : 0;
        double x = i < v->n || v->rest == REST_KEPT ? v->v[i] : 0;
        used += (size_t)format_number(text + used, room, 'f', width, digits, x);
    }
    *out = (struct value) { .type = VALUE_TEXT, .text = { text, used } };
}

void call_chr(struct arguments *a, struct value *out)
{
    double x = a->v[0].v[0];
    unsigned code = x >= 0 && x < 65536 ? (unsigned)x : 0;
    char text[4];
    size_t n = code > 0;                /* no text holds a zero */

    if (!(x >= 0 && x < 65536))
        diag_error(a->l->diag, a->node->at, "chr takes a code from 0 to 65535, not %g", x);
    if (code < 0x80)
        text[0] = (char)code;
    else if (code < 0x800) {
        text[0] = (char)(0xc0 | code >> 6);
        n = 2;
    } else {
        text[0] = (char)(0xe0 | code >> 12);
        text[1] = (char)(0x80 | (code >> 6 & 0x3f));
        n = 3;
    }
    if (n > 1)
        text[n - 1] = (char)(0x80 | (code & 0x3f));
    *out = text_of(a, text, n);
}

void call_substr(struct arguments *a, struct value *out)
{
    const struct text *t = &a->v[0].text;
    double start = trunc(a->v[1].v[0]), count = trunc(a->v[2].v[0]);

    *out = text_of(a, "", 0);
    if (!(start >= 0 || count == 0) || !(count >= 0) || start + count - 1 > (double)length(t)) {
        diag_error(a->l->diag, a->node->at,
                   "substr: characters %g to %g of a text of %zu", start, start + count - 1,
                   length(t));
        return;
    }
    if (count == 0 || start == 0)
        return;
    const char *from = skip(t, (size_t)start - 1);
    struct text rest = { from, (size_t)(t->bytes + t->size - from) };
    *out = text_of(a, from, (size_t)(skip(&rest, (size_t)count) - from));
}

static void change_case(struct arguments *a, struct value *out, char first, char last, int by)
{
    *out = text_of(a, a->v[0].text.bytes, a->v[0].text.size);
    for (char *p = (char *)out->text.bytes; p < out->text.bytes + out->text.size; p++)
        if (*p >= first && *p <= last)
            *p = (char)(*p + by);
}

void call_strupr(struct arguments *a, struct value *out) { change_case(a, out, 'a', 'z', -32); }
void call_strlwr(struct arguments *a, struct value *out) { change_case(a, out, 'A', 'Z', 32); }

void call_datetime(struct arguments *a, struct value *out)
{
    static const double epoch = 946684800;      /* 2000-01-01 in seconds since 1970 */
    const char *format = a->n > 1 ? a->v[1].text.bytes : "%Y-%m-%d %H:%M:%SZ";
    time_t when = (time_t)(floor(a->v[0].v[0] * 24 * 3600 + 0.5) + epoch);
    struct tm tm;
    char text[1024];

    *out = text_of(a, "", 0);
    if (!*format) {
        diag_error(a->l->diag, a->node->at, "datetime with an empty format");
        return;
    }
    size_t n = gmtime_r(&when, &tm) ? strftime(text, sizeof text, format, &tm) : 0;
    *out = text_of(a, text, n);
}

/* --- asking --------------------------------------------------------------------------- */

void call_val(struct arguments *a, struct value *out)
{
    *out = value_number(number_of_text(a->v[0].text.bytes));
}

void call_asc(struct arguments *a, struct value *out)
{
    const struct text *t = &a->v[0].text;
    size_t size;

    *out = value_number(t->size ? character(t->bytes, t->bytes + t->size, &size) : 0);
}

void call_strlen(struct arguments *a, struct value *out)
{
    *out = value_number((double)length(&a->v[0].text));
}

void call_strcmp(struct arguments *a, struct value *out)
{
    *out = value_number(difference(&a->v[0].text, &a->v[1].text));
}

/* povray.c: POV-Ray's own command line, as people and wrapper programs type
 * it (facts sdl.md 9): a row says what each switch and INI name does here. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/name.h"
#include "cli/options.h"

struct setting {
    const char *letters;                /* after the sign; NULL: none */
    const char *name;                   /* in INI files; NULL: none */
    bool (*read)(struct options *o, const struct setting *row, bool on, const char *value);
    size_t offset;                      /* of the member that is set */
    double low, high;                   /* of a number */
    const char *why;                    /* of what is refused or only warned of */
};

/* --- readers ------------------------------------------------------------- */

static const char *called(const struct setting *row)
{
    return row->name ? row->name : row->letters;
}

static void *member(struct options *o, const struct setting *row)
{
    return (char *)o + row->offset;
}

/* Trailing text is let pass, as POV-Ray does: "Width=3.7" is 3. */
static bool number(const struct setting *row, const char *value, double *out)
{
    char *end;

    *out = strtod(value, &end);
    if (end == value)
        return option_error("%s: a number is missing", called(row));
    if (!(*out >= row->low && *out <= row->high))
        return option_error("%s: %s is not between %.10g and %.10g", called(row), value, row->low,
                            row->high);
    return true;
}

static bool nothing(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)o, (void)row, (void)on, (void)value;
    return true;
}

static bool refuse(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)o, (void)on, (void)value;
    return option_error("%s: %s", called(row), row->why);
}

static bool refuse_on(struct options *o, const struct setting *row, bool on, const char *value)
{
    return !on || refuse(o, row, on, value);
}

static bool warn_on(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)value;
    if (on)
        option_warning(o, "%s: %s", called(row), row->why);
    return true;
}

/* Console streams are accepted; copies of them in files are not made. */
static bool warn_file(struct options *o, const struct setting *row, bool on, const char *value)
{
    return warn_on(o, row, on && *value, value);
}

static bool read_count(struct options *o, const struct setting *row, bool on, const char *value)
{
    double n;

    (void)on;
    if (!number(row, value, &n))
        return false;
    *(unsigned *)member(o, row) = (unsigned)n;
    return true;
}

/* POV-Ray takes +R0 for +R1. */
static bool read_depth(struct options *o, const struct setting *row, bool on, const char *value)
{
    unsigned *depth = member(o, row);

    if (!read_count(o, row, on, value))
        return false;
    *depth += *depth == 0;
    return true;
}

static bool read_int(struct options *o, const struct setting *row, bool on, const char *value)
{
    double n;

    (void)on;
    if (!number(row, value, &n))
        return false;
    *(int *)member(o, row) = (int)n;
    return true;
}

static bool read_real(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)on;
    return number(row, value, member(o, row));
}

static bool read_flag(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)value;
    *(bool *)member(o, row) = on;
    return true;
}

static bool read_list(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)on;
    if (!*value)
        return option_error("%s: a folder's name is missing", called(row));
    for (size_t n; *value; value += n + (value[n] != '\0')) {
        n = strcspn(value, ",");        /* several, between commas */
        if (n)
            list_add(o, member(o, row), arena_text(o->mem, value, n));
    }
    return true;
}

static bool exists(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0;
}

static bool has_extension(const char *path)
{
    const char *slash = strrchr(path, '/');

    return strchr(slash ? slash : path, '.') != NULL;
}

static bool set_scene(struct options *o, const char *path)
{
    const char *equals = strchr(path, '=');

    if (equals && !exists(path))
        return option_error("unknown option '%.*s'; rtc(1) lists those of POV-Ray that work",
                            (int)(equals - path), path);
    if (o->scene && strcmp(o->scene, path) != 0)
        return option_error("one scene at a time: '%s' and '%s'", o->scene, path);
    o->scene = path;
    return true;
}

static bool read_scene(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)on;
    if (!*value)
        return option_error("%s: the scene's name is missing", called(row));
    if (strcmp(value, "-") != 0 && !exists(value) && !has_extension(value))
        value = arena_format(o->mem, "%s.pov", value);
    o->scene = NULL;                    /* the last one counts */
    if (o->allow_write.n == 0)          /* as Debian's povray.conf has it */
        list_add(o, &o->allow_write, ".");
    return set_scene(o, value);
}

static bool read_output(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)row, (void)on;
    if (*value) {                       /* a bare +O means the default */
        o->output = value;
        o->povray_name = true;
    }
    return true;
}

static bool read_format(struct options *o, const struct setting *row, bool on, const char *value)
{
    if (toupper((unsigned char)value[0]) == 'N' && tolower((unsigned char)value[1]) == 'g')
        return option_error("%s: grey pictures are not supported yet", called(row));
    if (*value && toupper((unsigned char)*value) != 'N')
        return option_error("%s%s: only PNG pictures are written: +FN", called(row), value);
    if (row->letters)                   /* +F, -F; Output_File_Type switches nothing */
        o->no_file = !on;
    if (!*value || !value[1])
        return true;
    o->bits = atoi(value + 1) > 8 ? 16 : 8;
    return true;
}

static bool read_file_on(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)row, (void)value;
    o->no_file = !on;
    return true;
}

static bool read_bits(struct options *o, const struct setting *row, bool on, const char *value)
{
    double n;

    (void)on;
    if (!number(row, value, &n))
        return false;
    o->bits = n > 8 ? 16 : 8;
    return true;
}

static bool read_gamma(struct options *o, const struct setting *row, bool on, const char *value)
{
    return strcasecmp(value, "sRGB") == 0 || refuse(o, row, on, value);
}

/* POV-Ray samples more where neighbours differ; here every pixel gets the
 * samples that POV-Ray would take there at most. */
static bool read_antialias(struct options *o, const struct setting *row, bool on, const char *value)
{
    double threshold;

    o->antialias = on;
    if (*value && !number(row, value, &threshold))
        return false;
    if (*value && threshold >= 1)
        return option_error("%s: the threshold is below 1: '%s'", called(row), value);
    return true;
}

static bool read_quality(struct options *o, const struct setting *row, bool on, const char *value)
{
    double n;

    return number(row, value, &n) && warn_on(o, row, on && n < 9, value);
}

static bool read_clock(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)on;
    o->has_clock = true;
    return number(row, value, &o->clock);
}

static bool read_last_frame(struct options *o, const struct setting *row, bool on, const char *value)
{
    o->animation.is_on = true;
    return read_int(o, row, on, value);
}

static bool read_debug(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)row;
    o->no_debug = !on;
    if (on && *value)
        o->debug_file = value;
    return true;
}

static bool read_debug_file(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)row, (void)on;
    o->debug_file = *value ? value : NULL;
    return true;
}

/* Declare=Name=3.5, and Declare='Name="text"' as wrappers quote it. */
static bool read_declare(struct options *o, const struct setting *row, bool on, const char *value)
{
    size_t length = strlen(value);

    (void)on;
    if (length > 1 && strchr("'\"", value[0]) && value[length - 1] == value[0])
        value = arena_text(o->mem, value + 1, length - 2);
    if (!strchr(value, '=') || strchr("=0123456789", value[0]))
        return option_error("%s: not NAME=VALUE: '%s'", called(row), value);
    list_add(o, &o->declare, value);
    return true;
}

static bool read_header(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)on;
    if (strchr(value, '"'))
        return option_error("%s: a file's name without quotation marks: '%s'", called(row), value);
    o->header = *value ? value : NULL;
    return true;
}

static bool read_ini(struct options *o, const struct setting *row, bool on, const char *value)
{
    (void)row, (void)on;
    return ini_read(o, value);
}

/* --- the table ----------------------------------------------------------- */

#define AT(m) offsetof(struct options, m)
#define SHELL "commands of the shell are never run"
#define STREAM "copies of this stream are not written; only +GDfile is"

static const struct setting table[] = {
    { "I", "Input_File_Name", read_scene, 0, 0, 0, NULL },
    { "O", "Output_File_Name", read_output, 0, 0, 0, NULL },
    { "W", "Width", read_count, AT(width), 1, 1000000, NULL },
    { "H", "Height", read_count, AT(height), 1, 1000000, NULL },
    { "F", NULL, read_format, 0, 0, 0, NULL },
    { NULL, "Output_To_File", read_file_on, 0, 0, 0, NULL },
    { NULL, "Output_File_Type", read_format, 0, 0, 0, NULL },
    { NULL, "Bits_Per_Color", read_bits, 0, 5, 16, NULL },
    { NULL, "Grayscale_Output", refuse_on, 0, 0, 0, "grey pictures are not supported yet" },
    { NULL, "File_Gamma", read_gamma, 0, 0, 0, "pictures are written as sRGB only" },
    { NULL, "Display_Gamma", nothing, 0, 0, 0, NULL },
    { NULL, "Compression", nothing, 0, 0, 0, NULL },
    { "UA", "Output_Alpha", read_flag, AT(alpha), 0, 0, NULL },
    { "A", NULL, read_antialias, 0, 0, 1e9, NULL },
    { NULL, "Antialias", read_flag, AT(antialias), 0, 0, NULL },
    { NULL, "Antialias_Threshold", nothing, 0, 0, 0, NULL },
    { "AM", "Sampling_Method", nothing, 0, 0, 0, NULL },
    { "R", "Antialias_Depth", read_depth, AT(antialias_depth), 0, 9, NULL },
    { "J", "Jitter", nothing, 0, 0, 0, NULL },
    { NULL, "Jitter_Amount", nothing, 0, 0, 0, NULL },
    { "AG", "Antialias_Gamma", nothing, 0, 0, 0, NULL },
    { "Q", "Quality", read_quality, 0, 0, 1e9, "lower qualities are not supported; rendering in full" },
    { "SC", "Start_Column", read_real, AT(part[0]), 0, 1000000, NULL },
    { "EC", "End_Column", read_real, AT(part[1]), 0, 1000000, NULL },
    { "SR", "Start_Row", read_real, AT(part[2]), 0, 1000000, NULL },
    { "ER", "End_Row", read_real, AT(part[3]), 0, 1000000, NULL },
    { "C", "Continue_Trace", read_flag, AT(resume), 0, 0, NULL },
    { "D", "Display", nothing, 0, 0, 0, NULL },
    { "P", "Pause_When_Done", nothing, 0, 0, 0, NULL },
    { "X", "Test_Abort", nothing, 0, 0, 0, NULL },
    { NULL, "Test_Abort_Count", nothing, 0, 0, 0, NULL },
    { "V", "Verbose", nothing, 0, 0, 0, NULL },
    { "L", "Library_Path", read_list, AT(library), 0, 0, NULL },
    { "HI", "Include_Header", read_header, 0, 0, 0, NULL },
    { "MV", "Version", read_real, AT(version), 0.1, 3.89, NULL },
    { "K", "Clock", read_clock, 0, -1e300, 1e300, NULL },
    { "KFI", "Initial_Frame", read_int, AT(animation.initial_frame), 0, 1e6, NULL },
    { "KFF", "Final_Frame", read_last_frame, AT(animation.final_frame), 0, 1e6, NULL },
    { "KI", "Initial_Clock", read_real, AT(animation.initial_clock), -1e300, 1e300, NULL },
    { "KF", "Final_Clock", read_real, AT(animation.final_clock), -1e300, 1e300, NULL },
    { "SF", "Subset_Start_Frame", read_real, AT(animation.subset_start), 0, 1e6, NULL },
    { "EF", "Subset_End_Frame", read_real, AT(animation.subset_end), 0, 1e6, NULL },
    { "STP", "Frame_Step", read_int, AT(animation.step), 1, 1e6, NULL },
    { "KC", "Cyclic_Animation", read_flag, AT(animation.cyclic), 0, 0, NULL },
    { "UF", "Field_Render", refuse_on, 0, 0, 0, "fields are not supported" },
    { "UO", "Odd_Field", nothing, 0, 0, 0, NULL },
    { "GA", NULL, warn_file, 0, 0, 0, STREAM },
    { "GD", NULL, read_debug, 0, 0, 0, NULL },
    { "GF", NULL, warn_file, 0, 0, 0, STREAM },
    { "GR", NULL, warn_file, 0, 0, 0, STREAM },
    { "GS", NULL, warn_file, 0, 0, 0, STREAM },
    { "GW", NULL, warn_file, 0, 0, 0, STREAM },
    { "GI", "Create_Ini", refuse, 0, 0, 0, "writing an INI file is not supported" },
    { NULL, "All_Console", nothing, 0, 0, 0, NULL },
    { NULL, "Debug_Console", read_debug, 0, 0, 0, NULL },
    { NULL, "Debug_File", read_debug_file, 0, 0, 0, NULL },
    { NULL, "Fatal_Console", nothing, 0, 0, 0, NULL },
    { NULL, "Render_Console", nothing, 0, 0, 0, NULL },
    { NULL, "Statistic_Console", nothing, 0, 0, 0, NULL },
    { NULL, "Warning_Console", nothing, 0, 0, 0, NULL },
    { NULL, "All_File", warn_file, 0, 0, 0, STREAM },
    { NULL, "Fatal_File", warn_file, 0, 0, 0, STREAM },
    { NULL, "Render_File", warn_file, 0, 0, 0, STREAM },
    { NULL, "Statistic_File", warn_file, 0, 0, 0, STREAM },
    { NULL, "Warning_File", warn_file, 0, 0, 0, STREAM },
    { "WT", "Work_Threads", read_count, AT(threads), 1, 4096, NULL },
    { "WL", "Warning_Level", nothing, 0, 0, 0, NULL },
    { "MB", "Bounding_Threshold", nothing, 0, 0, 0, NULL },
    { NULL, "Bounding", nothing, 0, 0, 0, NULL },
    { "BM", "Bounding_Method", nothing, 0, 0, 0, NULL },
    { "BS", "Render_Block_Size", nothing, 0, 0, 0, NULL },
    { "RP", "Render_Pattern", nothing, 0, 0, 0, NULL },
    { "RS", "Render_Block_Step", nothing, 0, 0, 0, NULL },
    { "UR", "Remove_Bounds", nothing, 0, 0, 0, NULL },
    { "UL", "Light_Buffer", nothing, 0, 0, 0, NULL },
    { "UV", "Vista_Buffer", nothing, 0, 0, 0, NULL },
    { "SU", "Split_Unions", nothing, 0, 0, 0, NULL },
    { "TH", "Dither", warn_on, 0, 0, 0, "dithering is not supported; ignored" },
    { NULL, "Dither_Method", nothing, 0, 0, 0, NULL },
    { "SP", "Preview_Start_Size", nothing, 0, 0, 0, NULL },
    { "EP", "Preview_End_Size", nothing, 0, 0, 0, NULL },
    { "RFI", "Radiosity_From_File", warn_on, 0, 0, 0, "radiosity is not supported yet; ignored" },
    { "RFO", "Radiosity_To_File", warn_on, 0, 0, 0, "radiosity is not supported yet; ignored" },
    { "RF", "Radiosity_File_Name", nothing, 0, 0, 0, NULL },
    { "RVP", "Radiosity_Vain_Pretrace", nothing, 0, 0, 0, NULL },
    { NULL, "Declare", read_declare, 0, 0, 0, NULL },
    { NULL, "Include_INI", read_ini, 0, 0, 0, NULL },
    { NULL, "Pre_Scene_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "Pre_Frame_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "Post_Scene_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "Post_Frame_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "User_Abort_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "Fatal_Error_Command", refuse, 0, 0, 0, SHELL },
    { NULL, "Buffer_Output", nothing, 0, 0, 0, NULL },
    { NULL, "Buffer_Size", nothing, 0, 0, 0, NULL },
    { NULL, "Create_Histogram", nothing, 0, 0, 0, NULL },
    { NULL, "Histogram_Name", nothing, 0, 0, 0, NULL },
    { NULL, "Histogram_Grid_Size", nothing, 0, 0, 0, NULL },
    { NULL, "Histogram_Type", nothing, 0, 0, 0, NULL },
};
enum { N_SETTINGS = sizeof table / sizeof *table };

/* --- from words to rows -------------------------------------------------- */

/* The row with the most letters: +AM2 is not +A. */
static const struct setting *find_switch(const char *letters)
{
    const struct setting *best = NULL;

    for (const struct setting *row = table; row < table + N_SETTINGS; row++)
        if (row->letters && strncasecmp(letters, row->letters, strlen(row->letters)) == 0 &&
            (!best || strlen(row->letters) > strlen(best->letters)))
            best = row;
    return best;
}

static const struct setting *find_name(const char *name, size_t length)
{
    for (const struct setting *row = table; row < table + N_SETTINGS; row++)
        if (row->name && strlen(row->name) == length && strncasecmp(name, row->name, length) == 0)
            return row;
    return NULL;
}

bool povray_is_switch(const char *word)
{
    return (word[0] == '+' || word[0] == '-') && find_switch(word + 1);
}

static bool one_switch(struct options *o, const char *word)
{
    const struct setting *row = find_switch(word + 1);

    if (!row)
        return option_error("unknown switch '%s'; rtc(1) lists those of POV-Ray that work", word);
    return row->read(o, row, word[0] == '+', word + 1 + strlen(row->letters));
}

/* Where the next switch begins in "+W320 +H240 -D": a sign after a space. */
static const char *next_switch(const char *word)
{
    for (const char *c = word + 1; *c; c++)
        if (c[-1] == ' ' && (*c == '+' || *c == '-'))
            return c;
    return NULL;
}

bool povray_switches(struct options *o, const char *word)
{
    while (word) {
        const char *next = next_switch(word);
        size_t length = next ? (size_t)(next - word) : strlen(word);
        while (length && word[length - 1] == ' ')
            length--;
        if (!one_switch(o, arena_text(o->mem, word, length)))
            return false;
        word = next;
    }
    return true;
}

bool povray_is_assignment(const char *word)
{
    size_t length = strcspn(word, "= \t");

    return strchr(word, '=') && find_name(word, length) &&
           word[length + strspn(word + length, " \t")] == '=';
}

static bool is_true(const char *value)
{
    return strcasecmp(value, "on") == 0 || strcasecmp(value, "true") == 0 ||
           strcasecmp(value, "yes") == 0 || strcmp(value, "1") == 0;
}

/* A switch-like row wants to know on or off, another the value. */
static bool is_off(const struct setting *row, const char *value)
{
    return (row->read == read_flag || row->read == refuse_on || row->read == warn_on ||
            row->read == read_file_on || row->read == read_debug) && !is_true(value);
}

bool povray_assignment(struct options *o, const char *word)
{
    size_t length = strcspn(word, "= \t");
    const struct setting *row = find_name(word, length);

    if (!row)
        return option_error("unknown option '%.*s'", (int)length, word);
    const char *value = strchr(word, '=') + 1;
    value += strspn(value, " \t");
    bool on = !is_off(row, value);
    return row->read(o, row, on, row->read == read_debug ? "" : value);
}

static bool ends_in(const char *word, const char *end)
{
    size_t n = strlen(word), m = strlen(end);

    return n >= m && strcasecmp(word + n - m, end) == 0;
}

bool povray_bare(struct options *o, const char *word)
{
    if (!*word)
        return option_error("an empty word where a scene's name should be");
    if (ends_in(word, ".ini") || (ends_in(word, "]") && strstr(word, ".ini[")))
        return ini_read(o, word);
    if (ends_in(word, "/")) {
        list_add(o, &o->library, word);
        return true;
    }
    const char *ini = arena_format(o->mem, "%s.ini", word);
    return !exists(word) && !has_extension(word) && exists(ini) ? ini_read(o, ini) : set_scene(o, word);
}

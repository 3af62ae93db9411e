/* file.h: files that a scene reads and writes, and which it may. */
#ifndef RTC_FILE_H
#define RTC_FILE_H

#include "lang/state.h"

bool file_exists(struct lang *l, struct loc at, const char *name);

/* Which file a scene means, see lang_find_file; says nothing when quiet. */
const char *file_find(struct lang *l, struct loc at, const char *name,
                      const char *const *extensions, const char *what, bool quiet);

void file_open(struct lang *l, const struct ast *node);
void file_close(struct lang *l, const struct ast *node);
void file_read(struct lang *l, const struct ast *node);
void file_write(struct lang *l, const struct ast *node);
void files_end(struct lang *l);         /* closes all */

#endif

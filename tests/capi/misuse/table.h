/* What a row of the table is: a call that is wrong, the status that it has to give, and a part of its text. */
#ifndef TABLE_H
#define TABLE_H

#include "../scene.h"

static int rows = 0, wrong = 0;

/* A row of the table: the call, the status that it has to give, and a part of the text, in which nothing is called as in Rust. */
static void row(const char *call, LightovenStatus status, LightovenStatus expected, const char *words) {
    const char *text = lightoven_last_error();
    rows++;
    if (status != expected || !strstr(text, words) || strstr(text, "::")) {
        wrong++;
        printf("%s\n    gave %s, '%s'\n    expected %s, '%s'\n", call, lightoven_status_name(status), text,
               lightoven_status_name(expected), words);
    }
}

#define REFUSED(call, status, words) row(#call, call, LIGHTOVEN_STATUS_##status, words)
#define WORKS(call) row(#call, call, LIGHTOVEN_STATUS_OK, "")

/* A structure of a wrong size: none, too small, of a version that is not known, absurd. */
#define WRONG_SIZES(structure, call)                                                                                   \
    do {                                                                                                               \
        const size_t right = (structure).struct_size, sizes[] = {0, right - 1, right + 8, SIZE_MAX};                   \
        for (size_t size = 0; size < 4; size++) {                                                                      \
            (structure).struct_size = sizes[size];                                                                     \
            REFUSED(call, INVALID_ARGUMENT, "the size of");                                                            \
        }                                                                                                              \
        (structure).struct_size = right;                                                                               \
    } while (0)

/* Counts that no memory holds. */
#define WRONG_COUNTS(count, call, words)                                                                               \
    do {                                                                                                               \
        const size_t right = (count), counts[] = {SIZE_MAX, SIZE_MAX / 8, (size_t)1 << 40, (size_t)UINT32_MAX + 1};    \
        for (size_t i = 0; i < 4; i++) {                                                                               \
            (count) = counts[i];                                                                                       \
            REFUSED(call, INVALID_ARGUMENT, words);                                                                    \
        }                                                                                                              \
        (count) = right;                                                                                               \
    } while (0)

#endif

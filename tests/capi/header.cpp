/* The header before anything else; its version is the library's. */
#include <lightoven.h>

#include <stdio.h>

int main(void) {
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", LIGHTOVEN_VERSION_MAJOR, LIGHTOVEN_VERSION_MINOR,
             LIGHTOVEN_VERSION_PATCH);
    puts(lightoven_version());
    const char *a = version, *b = lightoven_version();
    while (*a && *a == *b) {
        a++, b++;
    }
    return *a != *b;
}

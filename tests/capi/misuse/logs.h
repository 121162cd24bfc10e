/* The log. */
#ifndef LOGS_H
#define LOGS_H

#include "table.h"

static int logged = 0;

static void log_within(uint32_t level, const char *text, void *user) {
    logged += level == LIGHTOVEN_LOG_LEVEL_WARNING && strstr(text, "albedo of material 'bright'") && user == &logged;
    REFUSED(lightoven_set_log(NULL, NULL), IN_USE, "the log is in use");
}

/* A callback that calls back, and one that is taken away. */
static void logs(void) {
    LightovenScene scene = {0};
    const LightovenMaterial bright = {sizeof bright, "bright", 0, 0, {2, 2, 2}, {0, 0, 0}, 0, 0};
    SIZED(LightovenSceneDesc, desc);
    desc.materials = &bright, desc.material_count = 1;
    WORKS(lightoven_set_log(log_within, &logged));
    WORKS(lightoven_scene_create(&desc, &scene));
    WORKS(lightoven_scene_destroy(scene));
    WORKS(lightoven_set_log(NULL, NULL));
    WORKS(lightoven_scene_create(&desc, &scene));
    WORKS(lightoven_scene_destroy(scene));
    if (logged != 1) {
        fail("lightoven_set_log", "the warning was not told once");
    }
}

#endif

/* Every function with NULL, with handles that are none any more, with wrong sizes and counts: a status and a text, no crash. */
#include "misuse/devices.h"
#include "misuse/frames.h"
#include "misuse/logs.h"
#include "misuse/scenes.h"
#include "misuse/settings.h"
#include "misuse/stretch.h"

int main(void) {
    if (strcmp(lightoven_last_error(), "") != 0 || strcmp(lightoven_status_name(1), "UNKNOWN") != 0) {
        fail("before any call", lightoven_last_error());
    }
    Engine engine;
    create_engine(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    LightovenScene scene = {0};
    devices(&engine);
    scenes();
    logs();
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &scene));
    settings_are_checked(engine.gpu, scene);
    at_a_stretch(engine.gpu, scene);
    within_frames(&engine, scene);
    LIGHTOVEN(lightoven_scene_destroy(scene));
    destroy_engine(&engine);
    printf("%d calls, %d of them otherwise than expected\n", rows, wrong);
    return wrong != 0;
}

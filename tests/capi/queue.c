/* An engine that hands its queue over twice: two threads bake at a time, each by a LightovenGpu of its own. */
#include "scene.h"

#include <pthread.h>

/* Bakes of a thread, and looks at each: some hundred submissions. */
enum { BAKES = 4, LOOKS = 40 };

static void *bakes(void *pointer) {
    const LightovenGpu gpu = *(const LightovenGpu *)pointer;
    LightovenScene scene = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &scene));
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16;
    settings.slice_ns = 0;
    for (int bake = 0; bake < BAKES; bake++) {
        LightovenBaker baker = {0};
        LIGHTOVEN(lightoven_baker_create(gpu, scene, &settings, &baker));
        SIZED(LightovenStop, stop);
        stop.samples = 64;
        LIGHTOVEN(lightoven_baker_bake(baker, &stop, NULL, NULL, NULL));
        float pixels[16 * 16 * 4];
        for (int look = 0; look < LOOKS; look++) {
            LIGHTOVEN(lightoven_baker_read_back(baker, pixels, 16 * 16));
        }
        LIGHTOVEN(lightoven_baker_destroy(baker));
    }
    LIGHTOVEN(lightoven_scene_destroy(scene));
    return NULL;
}

int main(void) {
    Engine engine;
    create_engine(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    const LightovenGpuDesc desc = describe_device(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    LightovenGpu again = {0};
    LIGHTOVEN(lightoven_gpu_create(&desc, &again));
    pthread_t thread;
    if (pthread_create(&thread, NULL, bakes, &again) != 0) {
        fail("pthread_create", "failed");
    }
    bakes(&engine.gpu);
    if (pthread_join(thread, NULL) != 0) {
        fail("pthread_join", "failed");
    }
    LIGHTOVEN(lightoven_gpu_destroy(again));
    destroy_engine(&engine);
    printf("2 threads, %d bakes each\n", BAKES);
    return 0;
}

/* An engine that hands its queue over several times: threads make GPUs and bakers of it, bake, submit and destroy at a time. */
#include "scene.h"

#include <pthread.h>
#include <sched.h>

/* GPUs that a thread makes one after the other, and looks at each one's bake; bakes of the baker that all know. */
enum { GPUS = 2, LOOKS = 20, BAKES = 16 };

static Engine engine;
static LightovenScene scene;
/* One bakes, others ask. */
static LightovenBaker shared;
/* Threads that make GPUs and have not ended. */
static int makers = 2;

static int goes_on(void) {
    return __atomic_load_n(&makers, __ATOMIC_SEQ_CST) > 0;
}

static LightovenBaker create_baker(LightovenGpu gpu, const LightovenFrameSettings *frames) {
    LightovenBaker baker = {0};
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16, settings.slice_ns = 0, settings.frames = frames;
    LIGHTOVEN(lightoven_baker_create(gpu, scene, &settings, &baker));
    return baker;
}

static LightovenGpu create_gpu(void) {
    LightovenGpu gpu = {0};
    const LightovenGpuDesc desc = describe_device(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    LIGHTOVEN(lightoven_gpu_create(&desc, &gpu));
    return gpu;
}

static void *makes(void *unused) {
    for (int made = 0; made < GPUS; made++) {
        const LightovenGpu gpu = create_gpu();
        const LightovenBaker baker = create_baker(gpu, NULL);
        SIZED(LightovenStop, stop);
        stop.samples = 64;
        LIGHTOVEN(lightoven_baker_bake_until(baker, &stop, NULL, NULL, NULL));
        float pixels[16 * 16 * 4];
        for (int look = 0; look < LOOKS; look++) {
            LIGHTOVEN(lightoven_baker_read_back(baker, pixels, 16 * 16));
        }
        LIGHTOVEN(lightoven_baker_destroy(baker));
        LIGHTOVEN(lightoven_gpu_destroy(gpu));
    }
    __atomic_sub_fetch(&makers, 1, __ATOMIC_SEQ_CST);
    return unused;
}

/* The only one that signals the engine's semaphore. */
static void *submits(void *frame_count) {
    const LightovenGpu gpu = create_gpu();
    SIZED(LightovenFrameSettings, frames);
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    const LightovenBaker baker = create_baker(gpu, &frames);
    SIZED(LightovenTimelinePoint, signal);
    signal.semaphore = engine.timeline;
    do {
        signal.value++;
        SIZED(LightovenFrameReport, report);
        LIGHTOVEN(lightoven_baker_submit(baker, 1000000, NULL, 0, &signal, 1, &report));
        VkSemaphoreWaitInfo wait;
        memset(&wait, 0, sizeof wait);
        wait.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO;
        wait.semaphoreCount = 1;
        wait.pSemaphores = &engine.timeline;
        wait.pValues = &signal.value;
        VULKAN(engine.vkWaitSemaphores(engine.device, &wait, UINT64_MAX));
        LIGHTOVEN(lightoven_baker_complete(baker, report.frame, NULL));
    } while (goes_on());
    *(uint64_t *)frame_count = signal.value;
    LIGHTOVEN(lightoven_baker_destroy(baker));
    LIGHTOVEN(lightoven_gpu_destroy(gpu));
    return NULL;
}

/* Calls that are made, or refused because the baker bakes. */
static void *asks(void *asked) {
    do {
        SIZED(LightovenStatistics, statistics);
        size_t length;
        uint64_t bytes;
        const LightovenStatus given[] = {lightoven_baker_statistics(shared, &statistics),
                                         lightoven_baker_left_out(shared, 0, NULL, 0, &length, &bytes)};
        for (int i = 0; i < 2; i++) {
            if (given[i] != LIGHTOVEN_STATUS_OK && given[i] != LIGHTOVEN_STATUS_IN_USE) {
                fail(lightoven_status_name(given[i]), lightoven_last_error());
            }
        }
        ++*(uint64_t *)asked;
        sched_yield();
    } while (goes_on());
    return NULL;
}

static void bake_what_others_ask_for(void) {
    SIZED(LightovenStop, stop);
    for (uint32_t bake = 1; bake <= BAKES; bake++) {
        stop.samples = 64 * bake;
        LightovenStatus status;
        do {
            status = lightoven_baker_bake_until(shared, &stop, NULL, NULL, NULL);
        } while (status == LIGHTOVEN_STATUS_IN_USE);
        check_status("lightoven_baker_bake_until", status);
    }
}

int main(void) {
    create_engine(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &scene));
    shared = create_baker(engine.gpu, NULL);
    void *(*const works[])(void *) = {makes, makes, submits, asks};
    uint64_t counts[4] = {0};
    pthread_t threads[4];
    for (int i = 0; i < 4; i++) {
        if (pthread_create(&threads[i], NULL, works[i], &counts[i]) != 0) {
            fail("pthread_create", "failed");
        }
    }
    bake_what_others_ask_for();
    for (int i = 0; i < 4; i++) {
        if (pthread_join(threads[i], NULL) != 0) {
            fail("pthread_join", "failed");
        }
    }
    LIGHTOVEN(lightoven_baker_destroy(shared));
    LIGHTOVEN(lightoven_scene_destroy(scene));
    destroy_engine(&engine);
    printf("5 threads: %d GPUs, %d bakes of one baker, %llu frames, %llu looks\n", 2 * GPUS, BAKES,
           (unsigned long long)counts[2], (unsigned long long)counts[3]);
    return 0;
}

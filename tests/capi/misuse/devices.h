/* Devices, and what they need. */
#ifndef DEVICES_H
#define DEVICES_H

#include "table.h"

static void requirements(const Engine *engine) {
    SIZED(LightovenRequirements, needed);
    const VkInstance instance = engine->instance;
    const VkPhysicalDevice physical = engine->physical_device;
    const PFN_vkGetInstanceProcAddr get = engine->get;
    REFUSED(lightoven_requirements(NULL, instance, physical, 0, &needed), INVALID_ARGUMENT, "vkGetInstanceProcAddr");
    REFUSED(lightoven_requirements(get, NULL, physical, 0, &needed), INVALID_ARGUMENT, "instance is VK_NULL_HANDLE");
    REFUSED(lightoven_requirements(get, instance, NULL, 0, &needed), INVALID_ARGUMENT, "physical device is VK_NULL");
    REFUSED(lightoven_requirements(get, instance, physical, 3, &needed), INVALID_ARGUMENT, "is 3; allowed is 0 to 2");
    REFUSED(lightoven_requirements(get, instance, physical, 0, NULL), INVALID_ARGUMENT, "requirements is NULL");
    WRONG_SIZES(needed, lightoven_requirements(get, instance, physical, 0, &needed));
}

static void gpus_are_described(const LightovenGpuDesc good) {
    LightovenGpu gpu = {0};
    LightovenGpuDesc desc = good;
    REFUSED(lightoven_gpu_create(NULL, &gpu), INVALID_ARGUMENT, "description of the GPU is NULL");
    REFUSED(lightoven_gpu_create(&desc, NULL), INVALID_ARGUMENT, "place is NULL");
    REFUSED(lightoven_gpu_create((const void *)((const char *)&desc + 1), &gpu), INVALID_ARGUMENT, "no multiple of");
    WRONG_SIZES(desc, lightoven_gpu_create(&desc, &gpu));
    WRONG_COUNTS(desc.device_extension_count, lightoven_gpu_create(&desc, &gpu), "device extensions is");
    WRONG_COUNTS(desc.instance_extension_count, lightoven_gpu_create(&desc, &gpu), "instance extensions is");
    desc.device_extension_count = 1, desc.device_extensions = NULL;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "device extensions is NULL");
    const char *no_name[] = {NULL};
    desc.device_extensions = no_name;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "number 0 of the device extensions is NULL");
    desc = good, desc.pipeline_cache_size = 5;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "pipeline cache is NULL");
    desc.pipeline_cache = "odd";
    WRONG_COUNTS(desc.pipeline_cache_size, lightoven_gpu_create(&desc, &gpu), "pipeline cache is");
    desc = good, desc.features = 0;
    REFUSED(lightoven_gpu_create(&desc, &gpu), UNSUPPORTED, "timelineSemaphore");
    desc = good, desc.backend = 17;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "17; allowed is 0 to 2");
    desc = good, desc.get_instance_proc_addr = NULL;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "vkGetInstanceProcAddr is NULL");
    desc = good, desc.device = NULL;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "the device is VK_NULL_HANDLE");
    desc = good, desc.queue = NULL;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_ARGUMENT, "the queue is VK_NULL_HANDLE");
    desc = good, desc.queue_family = 99;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_SETTINGS, "the family of the queue is 99; the device has");
    desc = good, desc.compute_queue = desc.queue, desc.compute_queue_family = UINT32_MAX;
    REFUSED(lightoven_gpu_create(&desc, &gpu), INVALID_SETTINGS, "queue for compute is 4294967295; the device has");
    if (gpu.id != 0) {
        fail("lightoven_gpu_create", "wrote a handle, and failed");
    }
}

static void gpus_are_used(const LightovenGpuDesc good) {
    LightovenGpu gpu = {0};
    WORKS(lightoven_gpu_create(&good, &gpu));
    SIZED(LightovenGpuInfo, info);
    REFUSED(lightoven_gpu_info(gpu, NULL), INVALID_ARGUMENT, "info is NULL");
    WRONG_SIZES(info, lightoven_gpu_info(gpu, &info));
    size_t size = 0;
    REFUSED(lightoven_gpu_pipeline_cache(gpu, NULL, NULL), INVALID_ARGUMENT, "size is NULL");
    WORKS(lightoven_gpu_pipeline_cache(gpu, &size, NULL));
    char *cache = malloc(size);
    size_t small = size - 1;
    REFUSED(lightoven_gpu_pipeline_cache(gpu, &small, cache), INVALID_ARGUMENT, "room for");
    WORKS(lightoven_gpu_pipeline_cache(gpu, &size, cache));
    LightovenGpu again = {0};
    LightovenGpuDesc desc = good;
    desc.pipeline_cache = cache, desc.pipeline_cache_size = size;
    WORKS(lightoven_gpu_create(&desc, &again));
    WORKS(lightoven_gpu_destroy(again));
    free(cache);

    const LightovenGpu null = {0}, made_up = {12345678};
    WORKS(lightoven_gpu_destroy(null));
    WORKS(lightoven_gpu_destroy(gpu));
    REFUSED(lightoven_gpu_destroy(gpu), INVALID_ARGUMENT, "there is no GPU");
    REFUSED(lightoven_gpu_destroy(made_up), INVALID_ARGUMENT, "there is no GPU 12345678");
    REFUSED(lightoven_gpu_info(null, &info), INVALID_ARGUMENT, "GPU is the null handle");
    REFUSED(lightoven_gpu_info(gpu, &info), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_gpu_pipeline_cache(gpu, &size, NULL), INVALID_ARGUMENT, "was destroyed");
}

static void devices(const Engine *engine) {
    const LightovenGpuDesc desc = describe_device(engine, LIGHTOVEN_BACKEND_SOFTWARE);
    requirements(engine);
    gpus_are_described(desc);
    gpus_are_used(desc);
}

#endif

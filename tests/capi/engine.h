/* A small engine: loads Vulkan by itself, links none of it, and is watched by the validation layers. For C11 and C++17. */
#ifndef ENGINE_H
#define ENGINE_H

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <lightoven.h>

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUNCTIONS(each)                                                                                                \
    each(vkDestroyInstance) each(vkEnumeratePhysicalDevices) each(vkGetPhysicalDeviceQueueFamilyProperties)            \
    each(vkCreateDevice) each(vkDestroyDevice) each(vkGetDeviceQueue) each(vkCreateCommandPool)                        \
    each(vkDestroyCommandPool) each(vkAllocateCommandBuffers) each(vkResetCommandBuffer) each(vkBeginCommandBuffer)    \
    each(vkEndCommandBuffer) each(vkQueueSubmit) each(vkCreateFence) each(vkDestroyFence) each(vkWaitForFences)        \
    each(vkResetFences) each(vkCreateSemaphore) each(vkDestroySemaphore) each(vkWaitSemaphores)                        \
    each(vkCreateDebugUtilsMessengerEXT) each(vkDestroyDebugUtilsMessengerEXT)

typedef struct Engine {
    void *library;
    PFN_vkGetInstanceProcAddr get;
#define MEMBER(name) PFN_##name name;
    FUNCTIONS(MEMBER)
#undef MEMBER
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical_device;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence fence;
    VkSemaphore timeline;
    LightovenRequirements needed;
    LightovenGpu gpu;
    int messages;
} Engine;

static inline void fail(const char *what, const char *text) {
    fprintf(stderr, "%s: %s\n", what, text);
    exit(1);
}

static inline void check_vulkan(const char *what, VkResult result) {
    if (result != VK_SUCCESS) {
        char text[32];
        snprintf(text, sizeof text, "VkResult %d", (int)result);
        fail(what, text);
    }
}

static inline void check_status(const char *what, LightovenStatus status) {
    if (status != LIGHTOVEN_STATUS_OK) {
        fprintf(stderr, "%s: ", lightoven_status_name(status));
        fail(what, lightoven_last_error());
    }
}

/* A structure of zeros that knows its size. */
#define SIZED(type, name)                                                                                              \
    type name;                                                                                                         \
    memset(&name, 0, sizeof name);                                                                                     \
    name.struct_size = sizeof name

/* Calls that have to succeed. */
#define VULKAN(call) check_vulkan(#call, call)
#define LIGHTOVEN(call) check_status(#call, call)

static VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                              VkDebugUtilsMessageTypeFlagsEXT types,
                                              const VkDebugUtilsMessengerCallbackDataEXT *data, void *messages) {
    (void)severity;
    (void)types;
    fprintf(stderr, "%s\n", data->pMessage);
    *(int *)messages += 1;
    return VK_FALSE;
}

static inline void create_instance(Engine *engine) {
    const char *layer = "VK_LAYER_KHRONOS_validation", *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features;
    memset(&features, 0, sizeof features);
    features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &enabled;
    VkApplicationInfo application;
    memset(&application, 0, sizeof application);
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info;
    memset(&info, 0, sizeof info);
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pNext = &features;
    info.pApplicationInfo = &application;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &layer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
    PFN_vkCreateInstance create = (PFN_vkCreateInstance)engine->get(NULL, "vkCreateInstance");
    VULKAN(create(&info, NULL, &engine->instance));
#define LOAD(name) engine->name = (PFN_##name)engine->get(engine->instance, #name);
    FUNCTIONS(LOAD)
#undef LOAD
    VkDebugUtilsMessengerCreateInfoEXT watch;
    memset(&watch, 0, sizeof watch);
    watch.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    watch.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    watch.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    watch.pfnUserCallback = receive;
    watch.pUserData = &engine->messages;
    VULKAN(engine->vkCreateDebugUtilsMessengerEXT(engine->instance, &watch, NULL, &engine->messenger));
}

static inline void create_device(Engine *engine) {
    uint32_t families = 16, has = LIGHTOVEN_DEVICE_FEATURE_ACCELERATION_STRUCTURE;
    VkQueueFamilyProperties properties[16];
    engine->vkGetPhysicalDeviceQueueFamilyProperties(engine->physical_device, &families, properties);
    while (engine->family < families && !(properties[engine->family].queueFlags & VK_QUEUE_GRAPHICS_BIT)) {
        engine->family += 1;
    }
    float priority = 1;
    VkDeviceQueueCreateInfo queue;
    memset(&queue, 0, sizeof queue);
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = engine->family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    uint32_t features = engine->needed.features;
    VkPhysicalDeviceRayQueryFeaturesKHR ray_query;
    memset(&ray_query, 0, sizeof ray_query);
    ray_query.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR;
    ray_query.rayQuery = (features & LIGHTOVEN_DEVICE_FEATURE_RAY_QUERY) != 0;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures;
    memset(&structures, 0, sizeof structures);
    structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
    structures.pNext = &ray_query;
    structures.accelerationStructure = (features & has) != 0;
    VkPhysicalDeviceVulkan13Features vulkan13;
    memset(&vulkan13, 0, sizeof vulkan13);
    vulkan13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    vulkan13.pNext = features & has ? &structures : NULL;
    vulkan13.dynamicRendering = (features & LIGHTOVEN_DEVICE_FEATURE_DYNAMIC_RENDERING) != 0;
    vulkan13.synchronization2 = (features & LIGHTOVEN_DEVICE_FEATURE_SYNCHRONIZATION2) != 0;
    vulkan13.maintenance4 = (features & LIGHTOVEN_DEVICE_FEATURE_MAINTENANCE4) != 0;
    VkPhysicalDeviceVulkan12Features vulkan12;
    memset(&vulkan12, 0, sizeof vulkan12);
    vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    vulkan12.pNext = &vulkan13;
    vulkan12.timelineSemaphore = (features & LIGHTOVEN_DEVICE_FEATURE_TIMELINE_SEMAPHORE) != 0;
    vulkan12.bufferDeviceAddress = (features & LIGHTOVEN_DEVICE_FEATURE_BUFFER_DEVICE_ADDRESS) != 0;
    VkDeviceCreateInfo info;
    memset(&info, 0, sizeof info);
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &vulkan12;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = engine->needed.device_extension_count;
    info.ppEnabledExtensionNames = engine->needed.device_extensions;
    VULKAN(engine->vkCreateDevice(engine->physical_device, &info, NULL, &engine->device));
    engine->vkGetDeviceQueue(engine->device, engine->family, 0, &engine->queue);
}

static inline void create_commands(Engine *engine) {
    VkCommandPoolCreateInfo pool;
    memset(&pool, 0, sizeof pool);
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = engine->family;
    VULKAN(engine->vkCreateCommandPool(engine->device, &pool, NULL, &engine->pool));
    VkCommandBufferAllocateInfo buffer;
    memset(&buffer, 0, sizeof buffer);
    buffer.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    buffer.commandPool = engine->pool;
    buffer.commandBufferCount = 1;
    VULKAN(engine->vkAllocateCommandBuffers(engine->device, &buffer, &engine->commands));
    VkFenceCreateInfo fence;
    memset(&fence, 0, sizeof fence);
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    VULKAN(engine->vkCreateFence(engine->device, &fence, NULL, &engine->fence));
    VkSemaphoreTypeCreateInfo kind;
    memset(&kind, 0, sizeof kind);
    kind.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO;
    kind.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    VkSemaphoreCreateInfo semaphore;
    memset(&semaphore, 0, sizeof semaphore);
    semaphore.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
    semaphore.pNext = &kind;
    VULKAN(engine->vkCreateSemaphore(engine->device, &semaphore, NULL, &engine->timeline));
}

/* What describes the engine's device to lightoven. */
static inline LightovenGpuDesc describe_device(const Engine *engine, uint32_t backend) {
    LightovenGpuDesc desc;
    memset(&desc, 0, sizeof desc);
    desc.struct_size = sizeof desc;
    desc.get_instance_proc_addr = engine->get;
    desc.instance = engine->instance;
    desc.physical_device = engine->physical_device;
    desc.device = engine->device;
    desc.queue = engine->queue;
    desc.queue_family = engine->family;
    static const char *const instance_extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    desc.instance_extensions = instance_extensions;
    desc.instance_extension_count = 1;
    desc.device_extensions = engine->needed.device_extensions;
    desc.device_extension_count = engine->needed.device_extension_count;
    desc.features = engine->needed.features;
    desc.backend = backend;
    return desc;
}

/* Makes an engine with the first device there is. Exits with 77 where the device has no such back end. */
static inline void create_engine(Engine *engine, uint32_t backend) {
    memset(engine, 0, sizeof *engine);
    engine->library = dlopen("libvulkan.so.1", RTLD_NOW);
    if (!engine->library) {
        fail("libvulkan.so.1", dlerror());
    }
    void *symbol = dlsym(engine->library, "vkGetInstanceProcAddr");
    memcpy(&engine->get, &symbol, sizeof symbol);
    create_instance(engine);
    uint32_t count = 1;
    VkResult found = engine->vkEnumeratePhysicalDevices(engine->instance, &count, &engine->physical_device);
    if (count == 0 || (found != VK_SUCCESS && found != VK_INCOMPLETE)) {
        fail("vkEnumeratePhysicalDevices", "no device");
    }
    engine->needed.struct_size = sizeof engine->needed;
    LightovenStatus status = lightoven_requirements(engine->get, engine->instance, engine->physical_device, backend,
                                                    &engine->needed);
    if (status == LIGHTOVEN_STATUS_UNSUPPORTED) {
        printf("skipped: %s\n", lightoven_last_error());
        exit(77);
    }
    check_status("lightoven_requirements", status);
    create_device(engine);
    create_commands(engine);
    LightovenGpuDesc desc = describe_device(engine, backend);
    LIGHTOVEN(lightoven_gpu_create(&desc, &engine->gpu));
}

/* Destroys everything; what the validation layers have said fails. */
static inline void destroy_engine(Engine *engine) {
    LIGHTOVEN(lightoven_gpu_destroy(engine->gpu));
    engine->vkDestroySemaphore(engine->device, engine->timeline, NULL);
    engine->vkDestroyFence(engine->device, engine->fence, NULL);
    engine->vkDestroyCommandPool(engine->device, engine->pool, NULL);
    engine->vkDestroyDevice(engine->device, NULL);
    engine->vkDestroyDebugUtilsMessengerEXT(engine->instance, engine->messenger, NULL);
    engine->vkDestroyInstance(engine->instance, NULL);
    dlclose(engine->library);
    if (engine->messages > 0) {
        fail("validation layers", "have said something");
    }
}

/* A frame with the bake in the engine's own command buffer, waited for. */
static inline LightovenFrameReport record_frame(Engine *engine, LightovenBaker baker, uint64_t budget_ns) {
    VkCommandBufferBeginInfo begin;
    memset(&begin, 0, sizeof begin);
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VULKAN(engine->vkResetCommandBuffer(engine->commands, 0));
    VULKAN(engine->vkBeginCommandBuffer(engine->commands, &begin));
    LightovenFrameReport report;
    report.struct_size = sizeof report;
    LIGHTOVEN(lightoven_baker_record(baker, engine->commands, budget_ns, &report));
    VULKAN(engine->vkEndCommandBuffer(engine->commands));
    VkSubmitInfo submit;
    memset(&submit, 0, sizeof submit);
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &engine->commands;
    VULKAN(engine->vkQueueSubmit(engine->queue, 1, &submit, engine->fence));
    VULKAN(engine->vkWaitForFences(engine->device, 1, &engine->fence, VK_TRUE, UINT64_MAX));
    VULKAN(engine->vkResetFences(engine->device, 1, &engine->fence));
    LIGHTOVEN(lightoven_baker_complete(baker, report.frame, NULL));
    return report;
}

/* Writes a light map as it lies in memory. */
static inline void write_pixels(LightovenBaker baker, const char *path) {
    LightovenLightMap light_map;
    light_map.struct_size = sizeof light_map;
    LIGHTOVEN(lightoven_baker_light_map(baker, &light_map));
    size_t count = (size_t)light_map.width * light_map.height;
    float *pixels = (float *)malloc(count * 4 * sizeof *pixels);
    LIGHTOVEN(lightoven_baker_read_back(baker, pixels, count));
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(pixels, 4 * sizeof *pixels, count, file) != count || fclose(file) != 0) {
        fail(path, "cannot be written");
    }
    free(pixels);
}

#endif

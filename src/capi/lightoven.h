/*
 * lightoven: light maps, baked with Vulkan, for engines in C and C++.
 *
 * Calls give a LightovenStatus; lightoven_last_error() has the text to it, for each thread its own. Every structure begins with
 * its size, which the caller sets: `LightovenStop stop = {.struct_size = sizeof stop};`. LightovenBakeSettings and
 * LightovenFrameSettings are then filled in by a function; with the others zero, or NULL, means that there is none. Handles are
 * numbers that are never used twice, and {0} is the null handle of each kind. Where nothing is said a pointer is not NULL and is
 * used within the call alone, an index is below what it counts, and texts are UTF-8.
 *
 * It is for targets of 64 bits. With volk, include volk.h first, or define VK_NO_PROTOTYPES.
 *
 * Written by cbindgen from src/capi.
 */

#ifndef LIGHTOVEN_H
#define LIGHTOVEN_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

// The version of the header.
#define LIGHTOVEN_VERSION_MAJOR 0

// The version of the header.
#define LIGHTOVEN_VERSION_MINOR 1

// The version of the header.
#define LIGHTOVEN_VERSION_PATCH 0

// Room for the name of a device or driver, bytes.
#define LIGHTOVEN_NAME_SIZE 256

// Room for names of extensions.
#define LIGHTOVEN_MOST_EXTENSIONS 8

// `LightovenBakeSettings::bounces`: as many as there are.
#define LIGHTOVEN_ALL_BOUNCES UINT32_MAX

// `LightovenFrameSettings::tolerable_latency_ns`: old light never leaves.
#define LIGHTOVEN_NEVER UINT64_MAX

// How a call ended.
enum LightovenStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // As it should.
    LIGHTOVEN_STATUS_OK = 0,
    // The device, driver or file lacks something that was asked for.
    LIGHTOVEN_STATUS_UNSUPPORTED = -1,
    // Device memory ran out, or host memory that a driver asks for, or a buffer is over the device's limit. Where the process
    // itself gets no memory any more it is ended, as Rust has it.
    LIGHTOVEN_STATUS_OUT_OF_MEMORY = -2,
    // The device was lost; everything on it is gone.
    LIGHTOVEN_STATUS_DEVICE_LOST = -3,
    // The scene cannot be baked as it is.
    LIGHTOVEN_STATUS_INVALID_SCENE = -4,
    // A setting is outside what is allowed.
    LIGHTOVEN_STATUS_INVALID_SETTINGS = -5,
    // A file could not be read or written.
    LIGHTOVEN_STATUS_IO = -6,
    // The driver failed in a way that none of the others describe.
    LIGHTOVEN_STATUS_DRIVER = -7,
    // The call itself is wrong: a NULL, a handle, a structure's size or a count.
    LIGHTOVEN_STATUS_INVALID_ARGUMENT = -8,
    // The handle is in use: by another thread, by the call that this one is made from, or by what was made from it.
    LIGHTOVEN_STATUS_IN_USE = -9,
    // A fault of lightoven itself; the text says where. What the call worked on can only be destroyed.
    LIGHTOVEN_STATUS_INTERNAL = -10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenStatus LightovenStatus;
#else
typedef int32_t LightovenStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How grave a message is.
enum LightovenLogLevel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Something could not be done.
    LIGHTOVEN_LOG_LEVEL_ERROR = 0,
    // Something was left out, clamped or taken for something else.
    LIGHTOVEN_LOG_LEVEL_WARNING = 1,
    // What may be of interest.
    LIGHTOVEN_LOG_LEVEL_INFO = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenLogLevel LightovenLogLevel;
#else
typedef uint32_t LightovenLogLevel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What traces the rays.
enum LightovenBackend
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Ray queries where the device has them in hardware, and they were enabled; else software.
    LIGHTOVEN_BACKEND_AUTO = 0,
    // A hierarchy in storage buffers, walked by compute shaders. Runs everywhere.
    LIGHTOVEN_BACKEND_SOFTWARE = 1,
    // VK_KHR_ray_query; refused where the device has none.
    LIGHTOVEN_BACKEND_RAY_QUERY = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenBackend LightovenBackend;
#else
typedef uint32_t LightovenBackend;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Features of a Vulkan device, bits of `LightovenRequirements::features` and `LightovenGpuDesc::features`.
enum LightovenDeviceFeature
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // VkPhysicalDeviceVulkan12Features::timelineSemaphore
    LIGHTOVEN_DEVICE_FEATURE_TIMELINE_SEMAPHORE = 1,
    // VkPhysicalDeviceVulkan12Features::bufferDeviceAddress
    LIGHTOVEN_DEVICE_FEATURE_BUFFER_DEVICE_ADDRESS = 2,
    // VkPhysicalDeviceVulkan13Features::dynamicRendering
    LIGHTOVEN_DEVICE_FEATURE_DYNAMIC_RENDERING = 4,
    // VkPhysicalDeviceVulkan13Features::synchronization2
    LIGHTOVEN_DEVICE_FEATURE_SYNCHRONIZATION2 = 8,
    // VkPhysicalDeviceVulkan13Features::maintenance4
    LIGHTOVEN_DEVICE_FEATURE_MAINTENANCE4 = 16,
    // VkPhysicalDeviceAccelerationStructureFeaturesKHR::accelerationStructure
    LIGHTOVEN_DEVICE_FEATURE_ACCELERATION_STRUCTURE = 32,
    // VkPhysicalDeviceRayQueryFeaturesKHR::rayQuery
    LIGHTOVEN_DEVICE_FEATURE_RAY_QUERY = 64,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenDeviceFeature LightovenDeviceFeature;
#else
typedef uint32_t LightovenDeviceFeature;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Whether an instance may be moved, removed and added while a baker runs.
enum LightovenMobility
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // It stays where it is: texels inside it are given up.
    LIGHTOVEN_MOBILITY_STATIC = 0,
    // It may move.
    LIGHTOVEN_MOBILITY_MOVABLE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenMobility LightovenMobility;
#else
typedef uint32_t LightovenMobility;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What lies beyond a texture's edge.
enum LightovenWrap
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The texture again.
    LIGHTOVEN_WRAP_REPEAT = 0,
    // The texture again, every other one mirrored.
    LIGHTOVEN_WRAP_MIRRORED_REPEAT = 1,
    // The edge's colour.
    LIGHTOVEN_WRAP_CLAMP_TO_EDGE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenWrap LightovenWrap;
#else
typedef uint32_t LightovenWrap;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Whether a surface answers when seen from behind.
enum LightovenSidedness
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Seen from behind it blocks light and is black.
    LIGHTOVEN_SIDEDNESS_SINGLE = 0,
    // Both sides show the same light.
    LIGHTOVEN_SIDEDNESS_DOUBLE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenSidedness LightovenSidedness;
#else
typedef uint32_t LightovenSidedness;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The kind of a light.
enum LightovenLightKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Shines from a point into all directions.
    LIGHTOVEN_LIGHT_KIND_POINT = 0,
    // Shines from a point into a cone.
    LIGHTOVEN_LIGHT_KIND_SPOT = 1,
    // Shines from infinitely far away.
    LIGHTOVEN_LIGHT_KIND_DIRECTIONAL = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenLightKind LightovenLightKind;
#else
typedef uint32_t LightovenLightKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The kind of a sky.
enum LightovenSkyKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // No light comes from it.
    LIGHTOVEN_SKY_KIND_BLACK = 0,
    // The same radiance from everywhere.
    LIGHTOVEN_SKY_KIND_CONSTANT = 1,
    // A radiance for every direction.
    LIGHTOVEN_SKY_KIND_MAP = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenSkyKind LightovenSkyKind;
#else
typedef uint32_t LightovenSkyKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Texts of a scene.
enum LightovenSceneText
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The name of an instance: what it is moved by is its index.
    LIGHTOVEN_SCENE_TEXT_INSTANCE = 0,
    // The name of a material.
    LIGHTOVEN_SCENE_TEXT_MATERIAL = 1,
    // The name of a light.
    LIGHTOVEN_SCENE_TEXT_LIGHT = 2,
    // A warning.
    LIGHTOVEN_SCENE_TEXT_WARNING = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenSceneText LightovenSceneText;
#else
typedef uint32_t LightovenSceneText;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What surfaces of a glTF file answer to.
enum LightovenGltfSidedness
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // As the materials' `doubleSided` says.
    LIGHTOVEN_GLTF_SIDEDNESS_AS_WRITTEN = 0,
    // Every surface answers on both sides.
    LIGHTOVEN_GLTF_SIDEDNESS_ALL_DOUBLE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenGltfSidedness LightovenGltfSidedness;
#else
typedef uint32_t LightovenGltfSidedness;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which way rays are sent. Whichever it is, the light map is the same but for its noise.
enum LightovenSampling
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // As it pays.
    LIGHTOVEN_SAMPLING_AUTO = 0,
    // By the cosine alone.
    LIGHTOVEN_SAMPLING_COSINE = 1,
    // Toward what shines alone; for comparisons.
    LIGHTOVEN_SAMPLING_IMPORTANCE = 2,
    // Both: `cosine_share` of the rays by the cosine.
    LIGHTOVEN_SAMPLING_MIXTURE = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenSampling LightovenSampling;
#else
typedef uint32_t LightovenSampling;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// By what aimed rays choose where they go.
enum LightovenAimedBy
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Luminance times area alone.
    LIGHTOVEN_AIMED_BY_POWER = 0,
    // And distance, and the cosines at both ends.
    LIGHTOVEN_AIMED_BY_DISTANCE = 1,
    // And what earlier rays have shown to be visible. The default.
    LIGHTOVEN_AIMED_BY_VISIBILITY = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenAimedBy LightovenAimedBy;
#else
typedef uint32_t LightovenAimedBy;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What is told of the error of a bake at a stretch.
enum LightovenErrorEstimate
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Nothing; a bake cannot end by it.
    LIGHTOVEN_ERROR_ESTIMATE_NONE = 0,
    // Its estimate. The default.
    LIGHTOVEN_ERROR_ESTIMATE_TOLD = 1,
    // And where a bake ends by it, texels that have converged stop before the others.
    LIGHTOVEN_ERROR_ESTIMATE_ADAPTIVE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenErrorEstimate LightovenErrorEstimate;
#else
typedef uint32_t LightovenErrorEstimate;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which time the running average goes by.
enum LightovenClock
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Time as it passes.
    LIGHTOVEN_CLOCK_WALL = 0,
    // What `lightoven_baker_set_time` says.
    LIGHTOVEN_CLOCK_ENGINE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenClock LightovenClock;
#else
typedef uint32_t LightovenClock;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What tells how long a frame took.
enum LightovenMeasure
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Timestamps of the device; where it has none the host's clock.
    LIGHTOVEN_MEASURE_TIMESTAMPS = 0,
    // The host's clock.
    LIGHTOVEN_MEASURE_HOST = 1,
    // Nothing, in a LightovenFrameTiming: the frame had nothing to do, or was reported complete before.
    LIGHTOVEN_MEASURE_NOTHING = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenMeasure LightovenMeasure;
#else
typedef uint32_t LightovenMeasure;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a bake is doing.
enum LightovenPhase
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Scene, hierarchy, g-buffer.
    LIGHTOVEN_PHASE_PREPARING = 0,
    // Finding out how light is reflected.
    LIGHTOVEN_PHASE_BOUNCES = 1,
    // Collecting samples.
    LIGHTOVEN_PHASE_SAMPLES = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenPhase LightovenPhase;
#else
typedef uint32_t LightovenPhase;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How a bake ended.
enum LightovenEnd
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The stop was reached.
    LIGHTOVEN_END_FINISHED = 0,
    // The callback ended it.
    LIGHTOVEN_END_INTERRUPTED = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenEnd LightovenEnd;
#else
typedef uint32_t LightovenEnd;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The passes of a frame, bits of `LightovenFrameReport::ran`.
enum LightovenRan
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Transforms, lights, emission or sky were written.
    LIGHTOVEN_RAN_UPDATE = 1,
    // The top level of the hierarchy was built anew.
    LIGHTOVEN_RAN_TOP_LEVEL = 2,
    // Light from analytic lights.
    LIGHTOVEN_RAN_DIRECT = 4,
    // Rays.
    LIGHTOVEN_RAN_BAKE = 8,
    // Outgoing radiance of texels.
    LIGHTOVEN_RAN_SOURCE = 16,
    // A light map was written, or a part of one.
    LIGHTOVEN_RAN_PUBLISH = 32,
    // What rays are aimed by was made anew, or a part of it.
    LIGHTOVEN_RAN_IMPORTANCE = 64,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LightovenRan LightovenRan;
#else
typedef uint32_t LightovenRan;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Takes a message. `level`: a LightovenLogLevel. `text`: UTF-8, ended by a NUL, valid within the call. It may be called by any
// thread that calls lightoven, by several at a time, and returns: no exception and no longjmp leaves it.
typedef void (*LightovenLogCallback)(uint32_t level, const char *text, void *user);

// What an engine enables on its device, beside what it needs itself.
typedef struct LightovenRequirements {
    // sizeof(LightovenRequirements)
    size_t struct_size;
    // A LightovenBackend that this is for: software or ray query.
    uint32_t backend;
    // Least version of the instance and of the device, as VK_MAKE_API_VERSION packs it.
    uint32_t api_version;
    // Bits of LightovenDeviceFeature.
    uint32_t features;
    // How many of `device_extensions` are used.
    uint32_t device_extension_count;
    // Names of device extensions, valid for ever.
    const char *device_extensions[LIGHTOVEN_MOST_EXTENSIONS];
} LightovenRequirements;

// Vulkan handles to bake with. Nothing of it is destroyed; all of it outlives the LightovenGpu, and its arrays are not
// needed after the call.
typedef struct LightovenGpuDesc {
    // sizeof(LightovenGpuDesc)
    size_t struct_size;
    // What the instance's functions are loaded by: all of Vulkan is called through it, and nothing is linked.
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    // An instance of Vulkan 1.3 or later.
    VkInstance instance;
    // The device's physical device.
    VkPhysicalDevice physical_device;
    // The device, created with what `lightoven_requirements` said.
    VkDevice device;
    // A queue with graphics, compute and transfer: set-up runs on it, and what is recorded into the engine's commands.
    VkQueue queue;
    // A queue with compute for `lightoven_baker_submit`. NULL: `queue`.
    VkQueue compute_queue;
    // The family of `queue`, with graphics and compute.
    uint32_t queue_family;
    // The family of `compute_queue`, with compute; not looked at where that is NULL, and that of `queue` where the two
    // are one.
    uint32_t compute_queue_family;
    // Extensions enabled on the instance, `[instance_extension_count]`. With VK_EXT_debug_utils objects are named and passes
    // labelled. NULL where the count is 0.
    const char *const *instance_extensions;
    // At most 2^32 - 1.
    size_t instance_extension_count;
    // Extensions enabled on the device, `[device_extension_count]`. NULL where the count is 0.
    const char *const *device_extensions;
    // At most 2^32 - 1.
    size_t device_extension_count;
    // What `lightoven_gpu_pipeline_cache` gave, perhaps in an earlier run. Bytes of another device or driver, or damaged ones,
    // are left aside with a warning. NULL where the size is 0. Nothing but those bytes: who makes up others with a right checksum
    // hands them to the driver.
    const void *pipeline_cache;
    // Bytes; at most 2^32 - 1.
    size_t pipeline_cache_size;
    // Features enabled on the device, bits of LightovenDeviceFeature; others are not looked at.
    uint32_t features;
    // A LightovenBackend.
    uint32_t backend;
} LightovenGpuDesc;

// A device to bake on. The null handle has the id 0. It may be used by several threads at a time.
typedef struct LightovenGpu {
    // Not for use.
    uint64_t id;
} LightovenGpu;

// What a device holds for its bakers.
typedef struct LightovenGpuInfo {
    // sizeof(LightovenGpuInfo)
    size_t struct_size;
    // A LightovenBackend: software or ray query.
    uint32_t backend;
    // Compute and graphics pipelines.
    uint32_t pipelines;
    // Device memory that buffers and images of lightoven hold, bytes.
    uint64_t allocated_bytes;
    // The device's name, UTF-8, ended by a NUL.
    char name[LIGHTOVEN_NAME_SIZE];
    // The driver's name and version, UTF-8, ended by a NUL; cut short where it is longer.
    char driver[LIGHTOVEN_NAME_SIZE];
} LightovenGpuInfo;

// A checked scene, read-only. The null handle has the id 0. It may be used by several threads at a time, and destroyed as
// soon as bakers have been made from it.
typedef struct LightovenScene {
    // Not for use.
    uint64_t id;
} LightovenScene;

// What a scene holds.
typedef struct LightovenSceneInfo {
    // sizeof(LightovenSceneInfo)
    size_t struct_size;
    // Triangles over all instances.
    uint64_t triangle_count;
    // Instances that can be baked; bakers count them as here.
    uint32_t instance_count;
    // Materials.
    uint32_t material_count;
    // Point, spot and directional lights.
    uint32_t light_count;
    // What was dropped, clamped or left out, one sentence each.
    uint32_t warning_count;
} LightovenSceneInfo;

// Triangles of one material. Attribute arrays are `[vertex]`.
typedef struct LightovenMeshPart {
    // sizeof(LightovenMeshPart)
    size_t struct_size;
    // Object-space x, y, z, `[vertex][3]`; triangles are counter-clockwise seen from the front. NULL where the count is 0.
    const float *positions;
    // Shading normals, `[vertex][3]`, of any length but 0. NULL: the triangle's own.
    const float *normals;
    // Light-map coordinates, 0 to 1, `[vertex][2]`. NULL: the part blocks and emits light and receives none.
    const float *light_map_uvs;
    // Coordinates in the albedo texture, `[vertex][2]`. NULL: (0, 0).
    const float *albedo_uvs;
    // Coordinates in the emission texture, `[vertex][2]`. NULL: (0, 0).
    const float *emission_uvs;
    // At most 2^32 - 1.
    size_t vertex_count;
    // `[3 * triangle]`, each below `vertex_count`. NULL where the count is 0.
    const uint32_t *indices;
    // A multiple of 3, at most 2^32 - 1. 0: every three vertices are a triangle.
    size_t index_count;
    // Index into the scene's materials.
    uint32_t material;
    // 0.
    uint32_t reserved;
} LightovenMeshPart;

// A mesh.
typedef struct LightovenMesh {
    // sizeof(LightovenMesh)
    size_t struct_size;
    // Shown in messages; UTF-8. NULL: none.
    const char *name;
    // `[part_count]`; NULL where the count is 0.
    const struct LightovenMeshPart *parts;
    // At most 2^32 - 1.
    size_t part_count;
} LightovenMesh;

// A placed copy of a mesh.
typedef struct LightovenInstance {
    // sizeof(LightovenInstance)
    size_t struct_size;
    // Shown in messages; UTF-8. NULL: none.
    const char *name;
    // Object to world: three rows of four, as VkTransformMatrixKHR has them, in double precision. NULL: identity. A singular one
    // leaves the instance out, with a warning, and those after it move up.
    const double *object_to_world;
    // Index into the scene's meshes.
    uint32_t mesh;
    // A LightovenMobility.
    uint32_t mobility;
} LightovenInstance;

// A texture as a material uses it.
typedef struct LightovenTextureUse {
    // sizeof(LightovenTextureUse)
    size_t struct_size;
    // Index into the scene's textures.
    uint32_t texture;
    // A LightovenWrap, horizontally.
    uint32_t wrap_u;
    // A LightovenWrap, vertically.
    uint32_t wrap_v;
    // 0.
    uint32_t reserved;
} LightovenTextureUse;

// A diffuse, possibly emissive surface. Colours are linear, Rec. 709.
typedef struct LightovenMaterial {
    // sizeof(LightovenMaterial)
    size_t struct_size;
    // Shown in messages; UTF-8. NULL: none.
    const char *name;
    // Multiplied with `albedo`. NULL: none.
    const struct LightovenTextureUse *albedo_texture;
    // Multiplied with `emission`. NULL: none.
    const struct LightovenTextureUse *emission_texture;
    // Diffuse albedo, at least 0. Over 0.999, or no number, it is clamped with a warning; before a texture up to 1 without one.
    float albedo[3];
    // Emitted radiance, at least 0.
    float emission[3];
    // A LightovenSidedness.
    uint32_t sidedness;
    // 0.
    uint32_t reserved;
} LightovenMaterial;

// An image with sRGB encoding.
typedef struct LightovenTexture {
    // sizeof(LightovenTexture)
    size_t struct_size;
    // Shown in messages; UTF-8. NULL: none.
    const char *name;
    // Red, green, blue and an alpha that is not used, 8 bits each: `[height][width][4]`, from the top. Not NULL.
    const uint8_t *pixels;
    // Columns, at least 1.
    uint32_t width;
    // Rows, at least 1.
    uint32_t height;
} LightovenTexture;

// An analytic light.
typedef struct LightovenLight {
    // sizeof(LightovenLight)
    size_t struct_size;
    // Shown in messages; UTF-8. NULL: none.
    const char *name;
    // Point and spot: world position.
    double position[3];
    // Spot and directional: the way the light travels, of any length but 0.
    float direction[3];
    // Linear Rec. 709. Point and spot: radiant intensity; directional: irradiance on a surface that faces it.
    float intensity[3];
    // Point and spot: distance at which the light has faded to 0, scene units. 0: it never does.
    float range;
    // Spot: angle from the axis up to which it shines fully, radians.
    float inner_angle;
    // Spot: angle from the axis beyond which it does not shine, radians; more than `inner_angle`, at most pi/2.
    float outer_angle;
    // A LightovenLightKind.
    uint32_t kind;
} LightovenLight;

// What a ray sees that leaves the scene.
typedef struct LightovenSky {
    // sizeof(LightovenSky)
    size_t struct_size;
    // Map: radiance, linear Rec. 709, `[height][width][3]`, equirectangular, from the top. The y axis is up; a direction d is
    // at column width * (atan2(d.z, d.x) / 2 pi + 1/2) and row height * acos(d.y) / pi. Else not looked at.
    const float *pixels;
    // Map: columns, at least 1.
    uint32_t width;
    // Map: rows, at least 1.
    uint32_t height;
    // Constant: radiance, linear Rec. 709, at least 0.
    float radiance[3];
    // A LightovenSkyKind.
    uint32_t kind;
} LightovenSky;

// Everything that makes up a scene.
typedef struct LightovenSceneDesc {
    // sizeof(LightovenSceneDesc)
    size_t struct_size;
    // Shown in messages and written into files; UTF-8. NULL: none.
    const char *name;
    // `[mesh_count]`; NULL where the count is 0, as with the other lists.
    const struct LightovenMesh *meshes;
    // At most 2^32 - 1, as the other counts.
    size_t mesh_count;
    // `[instance_count]`
    const struct LightovenInstance *instances;
    // Number of instances.
    size_t instance_count;
    // `[material_count]`
    const struct LightovenMaterial *materials;
    // Number of materials.
    size_t material_count;
    // `[texture_count]`
    const struct LightovenTexture *textures;
    // Number of textures.
    size_t texture_count;
    // `[light_count]`
    const struct LightovenLight *lights;
    // Number of lights.
    size_t light_count;
    // NULL: black.
    const struct LightovenSky *sky;
} LightovenSceneDesc;

// How glTF is read. NULL in its place: as written, with a black sky.
typedef struct LightovenGltf {
    // sizeof(LightovenGltf)
    size_t struct_size;
    // glTF has no sky of its own. NULL: black.
    const struct LightovenSky *sky;
    // A LightovenGltfSidedness.
    uint32_t sidedness;
    // 0.
    uint32_t reserved;
} LightovenGltf;

// How a baker behaves that works within an engine's frames. `lightoven_frame_settings_default` fills it in.
typedef struct LightovenFrameSettings {
    // sizeof(LightovenFrameSettings)
    size_t struct_size;
    // After so long `decay_threshold` of the old light is left, nanoseconds; default half a second.
    uint64_t tolerable_latency_ns;
    // Between 0 and 1, both excluded; default .1.
    double decay_threshold;
    // Frames that may be recorded before the oldest of them is reported complete; 1 to 8, default 3.
    uint32_t frames_in_flight;
    // A LightovenClock; default wall.
    uint32_t clock;
    // A LightovenMeasure for the cost model: timestamps (the default) or host.
    uint32_t measured_by;
    // Rays of a visit to a texel, in quanta of 16; 1 to 64. 0, the default: 1, and more where a frame has time for more.
    uint32_t quanta;
} LightovenFrameSettings;

// How to bake. `lightoven_bake_settings_default` fills it in.
typedef struct LightovenBakeSettings {
    // sizeof(LightovenBakeSettings)
    size_t struct_size;
    // Another seed gives other noise; default 0.
    uint64_t seed;
    // How long one submission of a bake at a stretch may take, nanoseconds; default 50 ms. 0: the least that can be submitted.
    uint64_t slice_ns;
    // NULL, the default: the scene stays as it is, and `lightoven_baker_bake` bakes it. Else it changes, and
    // `lightoven_baker_record` or `lightoven_baker_submit` work within an engine's frames.
    const struct LightovenFrameSettings *frames;
    // Side of the light map in texels, 1 to 16384, where `texels_per_unit` is 0; default 512.
    uint32_t resolution;
    // Texels for one scene unit of length; default 0: as `resolution` says.
    float texels_per_unit;
    // How many times light is reflected: 0 to 16384, or LIGHTOVEN_ALL_BOUNCES, the default, which frames insist on, and which
    // ends where the next one adds nothing to speak of. Of a number all are done: each costs a pass over the light map.
    uint32_t bounces;
    // A LightovenSampling; default auto.
    uint32_t sampling;
    // Share of rays by the cosine in a mixture, .1 to 1; default .5. Else not looked at.
    float cosine_share;
    // A LightovenAimedBy; default visibility.
    uint32_t aimed_by;
    // A LightovenErrorEstimate; default told.
    uint32_t error;
    // 0.
    uint32_t reserved;
} LightovenBakeSettings;

// What a bake will take.
typedef struct LightovenEstimate {
    // sizeof(LightovenEstimate)
    size_t struct_size;
    // Most device memory that the baker ever takes, while it is made too; bytes, to about 5 %.
    uint64_t most_bytes;
    // Device memory that it holds once it is made.
    uint64_t held_bytes;
    // Texels whose centre a surface covers.
    uint64_t covered_texels;
    // Columns of the light map.
    uint32_t width;
    // Rows of the light map.
    uint32_t height;
} LightovenEstimate;

// Bakes the light map of one scene on one device. The null handle has the id 0. One thread at a time: a call while another one
// works on the same baker, also from that one's callback, gives IN_USE. Destroy it once every frame that it recorded or
// submitted, and every frame that uses one of its light maps, has finished on the device.
typedef struct LightovenBaker {
    // Not for use.
    uint64_t id;
} LightovenBaker;

// The newest finished light map on the device. It is not written again before the frame after the one that replaced it has been
// reported complete: use it in the next frame that is recorded, and ask again for the one after.
typedef struct LightovenLightMap {
    // sizeof(LightovenLightMap)
    size_t struct_size;
    // The image.
    VkImage image;
    // A view of all of it; one of three, and the same for the same image.
    VkImageView view;
    // Grows by 1 with every finished map; 0: none is finished yet. Always 0 for a scene that stays as it is.
    uint64_t generation;
    // Sweeps over all texels that it holds. Always 0 for a scene that stays as it is.
    uint64_t sweeps;
    // VK_FORMAT_R32G32B32A32_SFLOAT. RGB: irradiance, linear Rec. 709, scene units; A: 1 where the texel lies on a surface, else 0.
    // Gutters are filled. Not every device filters such images linearly.
    VkFormat format;
    // The layout that the image is in, now and always.
    VkImageLayout layout;
    // Columns.
    uint32_t width;
    // Rows; the first is light-map coordinate v = 0.
    uint32_t height;
} LightovenLightMap;

// What a baker has done.
typedef struct LightovenStatistics {
    // sizeof(LightovenStatistics)
    size_t struct_size;
    // Texels that take rays.
    uint64_t texels;
    // Texels on a surface that are inside something and are filled from their neighbours.
    uint64_t invalid_texels;
    // Rays traced, shadow rays of analytic lights not counted.
    uint64_t rays;
    // Samples of a texel, in the mean.
    double samples_per_texel;
    // Million rays a second of baking; 0 before a bake has begun, and within frames.
    double mrays_per_s;
    // Root of relMSE as it is estimated; below 0: not known.
    float estimated_error;
    // Bound on what further bounces would add, relative to the mean radiance: infinite before two are done, and 0 before
    // a bake has begun, and within frames.
    float bounces_missing;
    // Epochs finished.
    uint32_t epochs;
    // What was noticed, one sentence each.
    uint32_t warning_count;
    // Samples of the texels that have most; with LIGHTOVEN_ERROR_ESTIMATE_ADAPTIVE others may have fewer. 0 within frames.
    double most_samples;
    // World area of the texels that take rays, square scene units; 0 until a bake has begun, and within frames.
    double area;
    // Rays sent by the cosine so far.
    uint64_t cosine_rays;
    // Rays aimed at the light map so far.
    uint64_t source_rays;
    // Rays aimed at the sky map so far.
    uint64_t sky_rays;
    // What all surfaces shine, lately: luminance times world area in square scene units; below 0: not known.
    double power;
    // Texels whose radiance is negative, infinite or no number, lately: no ray is aimed at them.
    uint64_t unaimed_texels;
    // Times that what rays are aimed by was made from the light map.
    uint64_t pyramids;
    // Time for the hierarchy on the host, nanoseconds, as all times.
    uint64_t bvh_ns;
    // For the layout of the light map, the upload of the scene and the g-buffer.
    uint64_t gbuffer_ns;
    // For finding what rays can be aimed at.
    uint64_t aiming_ns;
    // For the first source map and light from analytic lights.
    uint64_t direct_ns;
    // For what rays are aimed by.
    uint64_t importance_ns;
    // For rays and source maps. Times within frames are those of LightovenFrameTiming.
    uint64_t bake_ns;
    // For light maps, their gutters and error estimates.
    uint64_t resolve_ns;
    // For pipelines, and what the driver compiles at their first use.
    uint64_t compile_ns;
    // Share of rays sent by the cosine at present, a mixture's alpha; 0 to 1, as all shares. Before the first ray
    // these three are 0.
    float cosine_share;
    // Share of rays aimed at the light map at present.
    float source_share;
    // Share of rays aimed at the sky map at present.
    float sky_share;
    // Share of the rays aimed at the light map that saw what they were aimed at, lately; below 0: none was aimed, or it is
    // not known yet.
    float source_seen;
    // Share of the rays aimed at the sky map that left the scene, lately; below 0: none was aimed, or it is not known yet.
    float sky_seen;
    // How even what shines is: 1 where all surfaces have one radiance, toward 0 the smaller the part is that shines; below 0: not
    // known.
    float evenness;
    // What is left out because scene and settings do not need it; `lightoven_baker_left_out` has words for it.
    uint32_t left_out_count;
    // 1: the light map can only be black, and nothing was built; else 0.
    uint32_t dark;
} LightovenStatistics;

// The layout of a light map.
typedef struct LightovenAtlas {
    // sizeof(LightovenAtlas)
    size_t struct_size;
    // Texels whose centre a surface covers.
    uint64_t covered_texels;
    // Texels whose centre is covered more than once: their light is that of one of the surfaces.
    uint64_t overlapping_texels;
    // Columns.
    uint32_t width;
    // Rows.
    uint32_t height;
    // Instances that have a LightovenAtlasRect.
    uint32_t rect_count;
    // 1: the instances' own coordinates make up one atlas, used as it is; 0: each has a rectangle of its own.
    uint32_t shared;
} LightovenAtlas;

// An instance's place: texel = light-map coordinate * `scale` + `offset`. For a coordinate of the whole map divide by its width
// and height.
typedef struct LightovenAtlasRect {
    // sizeof(LightovenAtlasRect)
    size_t struct_size;
    // Texels for a light-map coordinate of 1, horizontally and vertically.
    float scale[2];
    // Texel of light-map coordinate (0, 0).
    float offset[2];
} LightovenAtlasRect;

// When a bake ends: at whichever comes first. With nothing set it goes on until its callback ends it.
typedef struct LightovenStop {
    // sizeof(LightovenStop)
    size_t struct_size;
    // Time from the call, nanoseconds; with `lightoven_baker_bake_until` that of all calls. 0: no limit.
    uint64_t time_ns;
    // Rays a texel; rounded up to a multiple of 64, at most 2^30. 0: no limit.
    uint32_t samples;
    // Estimated relative error of the irradiance, the root of relMSE, more than 0. 0: no limit.
    float error;
} LightovenStop;

// How far a bake is.
typedef struct LightovenProgress {
    // sizeof(LightovenProgress)
    size_t struct_size;
    // Rays traced.
    uint64_t rays;
    // Samples of a texel, in the mean.
    uint64_t samples_per_texel;
    // Time since the call, or that of all calls, as the stop's time counts; nanoseconds.
    uint64_t elapsed_ns;
    // Time to the stop at the rate so far, nanoseconds; the largest number while it cannot be told.
    uint64_t time_left_ns;
    // Million rays a second of baking.
    double mrays_per_s;
    // How far it is on the way to the stop, 0 to 1.
    float fraction;
    // Root of relMSE as it is estimated; below 0: not known yet.
    float estimated_error;
    // A LightovenPhase.
    uint32_t phase;
    // Epochs finished.
    uint32_t epoch;
} LightovenProgress;

// Called between slices of a bake, on the thread that bakes. `progress` is valid within the call, `user` is what
// `lightoven_baker_bake` was given. 0: the bake goes on; else it ends, and keeps what it has. It returns: no exception and no
// longjmp leaves it.
typedef int32_t (*LightovenProgressCallback)(const struct LightovenProgress *progress, void *user);

// What a frame was given to do.
typedef struct LightovenFrameReport {
    // sizeof(LightovenFrameReport)
    size_t struct_size;
    // The frame, numbered from 1, to be reported complete.
    uint64_t frame;
    // Rays of gathering.
    uint64_t rays;
    // Rays a texel, over all texels that take rays: a fraction where tiles take turns.
    double samples_per_texel;
    // How long the cost model expects it to take, nanoseconds.
    uint64_t predicted_ns;
    // How long the least that is dispatched is expected to take, nanoseconds.
    uint64_t one_unit_ns;
    // Sweeps over all texels finished so far.
    uint64_t sweeps;
    // Bits of LightovenRan: the passes that were recorded.
    uint32_t ran;
    // Dispatches of direct light, rays, outgoing radiance and light maps.
    uint32_t dispatches;
    // 1: old light leaves the running average, because something has changed lately; else 0.
    uint32_t decaying;
    // 1: nothing was recorded, since as many frames as may be in flight had not been reported complete; else 0.
    uint32_t held_up;
} LightovenFrameReport;

// A value of a timeline semaphore.
typedef struct LightovenTimelinePoint {
    // sizeof(LightovenTimelinePoint)
    size_t struct_size;
    // A timeline semaphore of the device.
    VkSemaphore semaphore;
    // The value to wait for, or to signal.
    uint64_t value;
} LightovenTimelinePoint;

// How long a frame took.
typedef struct LightovenFrameTiming {
    // sizeof(LightovenFrameTiming)
    size_t struct_size;
    // The frame.
    uint64_t frame;
    // Time of the baker's work on the device, nanoseconds.
    uint64_t bake_ns;
    // A LightovenMeasure. Nothing: the frame had nothing to do or was reported before, and the time is 0.
    uint32_t measured_by;
    // 1: a pipeline ran for the first time, and the driver may have compiled it within the frame; else 0.
    uint32_t first_use;
} LightovenFrameTiming;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library, as "major.minor.patch"; compare it with the header's. Valid for ever.
const char *lightoven_version(void);

// What the last call of this thread that failed has to say: the thing, its value, what is allowed. UTF-8, ended by a NUL,
// valid until the next call of this thread that fails, or until the thread ends; empty before the first. Never NULL.
const char *lightoven_last_error(void);

// A status's name, as in the header without its prefix; "UNKNOWN" for what is none. Never NULL, valid for ever.
const char *lightoven_status_name(int32_t status);

// Where messages go that lightoven has beside its errors; NULL: nowhere, as at the beginning. `user`: passed on. When the call
// returns, the callback before is not called any more.
//
// UNSUPPORTED where something else in the process takes the messages of its Rust code already; IN_USE from within a callback.
//
// # Safety
// `callback` may be called with `user` by any thread that calls lightoven, until another is set.
LightovenStatus lightoven_set_log(LightovenLogCallback callback,
                                  void *user);

// Tells what to enable on a device before it is made. `backend`: a LightovenBackend. `requirements`: filled in, not NULL;
// its `struct_size` is set before.
//
// # Safety
// The instance is valid and was made by the library that `get_instance_proc_addr` belongs to; the physical device is the
// instance's; `requirements` may be written.
LightovenStatus lightoven_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                       VkInstance instance,
                                       VkPhysicalDevice physical_device,
                                       uint32_t backend,
                                       struct LightovenRequirements *requirements);

// Takes an engine's device. `desc`, `gpu`: not NULL. `gpu` is written only where the call succeeds. UNSUPPORTED names an
// extension or feature that is required and was not enabled, INVALID_SETTINGS a queue family that the device does not have or
// that cannot do the work, or two families of one queue.
//
// # Safety
// - `desc` and what it points to are as its members say; the handles are valid and belong together; extensions and features
//   are those that the device was created with.
// - All of them outlive the LightovenGpu.
// - The engine does not use the queues during `lightoven_baker_create`, `_bake`, `_bake_until`, `_read_back`, `_write_exr`,
//   `_write_png` and `_set_scene`, nor the queue for compute during `lightoven_baker_submit`: Vulkan wants one thread at a time
//   there. Calls of lightoven's may come from several threads: where they use one queue they wait for each other, whichever
//   LightovenGpu they go by.
LightovenStatus lightoven_gpu_create(const struct LightovenGpuDesc *desc,
                                     struct LightovenGpu *gpu);

// Lets the device go; nothing that the engine made is destroyed. Nothing happens for the null handle. IN_USE while bakers of
// it live.
LightovenStatus lightoven_gpu_destroy(struct LightovenGpu gpu);

// Tells what a device holds. `info`: not NULL; its `struct_size` is set before.
//
// # Safety
// `info` may be written.
LightovenStatus lightoven_gpu_info(struct LightovenGpu gpu, struct LightovenGpuInfo *info);

// Gives the compiled pipelines as bytes, for the engine to keep and hand in the next time. `size`: not NULL; with `data` NULL it
// is set to the bytes there are, else it tells the room at `data` and is set to what was written. INVALID_ARGUMENT where the
// room is too small, for pipelines that were compiled in between made it grow: `size` is then set to what is needed.
//
// # Safety
// `size` may be read and written; `data` is NULL or has room for as many bytes.
LightovenStatus lightoven_gpu_pipeline_cache(struct LightovenGpu gpu,
                                             size_t *size,
                                             void *data);

// Destroys a scene. Nothing happens for the null handle. IN_USE while another thread uses it.
LightovenStatus lightoven_scene_destroy(struct LightovenScene scene);

// Tells what a scene holds. `info`: not NULL; its `struct_size` is set before.
//
// # Safety
// `info` may be written.
LightovenStatus lightoven_scene_info(struct LightovenScene scene, struct LightovenSceneInfo *info);

// Gives a text of a scene: UTF-8, ended by a NUL, cut short where `capacity` is too small for all of it.
//
// `kind`: a LightovenSceneText. `index`: below the count of these in LightovenSceneInfo. `buffer`: room for `capacity` bytes, or
// NULL. `length`: set to the whole text's bytes without the NUL, or NULL; not both are NULL.
//
// # Safety
// `buffer` has room for `capacity` bytes where it is not NULL; `length` may be written where it is not NULL.
LightovenStatus lightoven_scene_text(struct LightovenScene scene,
                                     uint32_t kind,
                                     uint32_t index,
                                     char *buffer,
                                     size_t capacity,
                                     size_t *length);

// Checks a scene and takes it over. `desc`, `scene`: not NULL. `scene` is written only where the call succeeds; nothing of the
// description is needed after it.
//
// INVALID_SCENE names the mesh, material, instance or light, the value and what is allowed. Triangles without area are dropped,
// instances with a singular transform left out and albedo clamped; warnings say so (`lightoven_scene_text`).
//
// # Safety
// `desc` and what it points to are as its members say; `scene` may be written.
LightovenStatus lightoven_scene_create(const struct LightovenSceneDesc *desc,
                                       struct LightovenScene *scene);

// Reads a .gltf or .glb file: its TEXCOORD_1 is the light map, what an animation moves is movable. `path`: UTF-8, not NULL.
// `gltf`: NULL for the defaults. `scene`: not NULL, written only where the call succeeds.
//
// # Safety
// `path` ends with a NUL; `gltf` is NULL or as its members say; `scene` may be written.
LightovenStatus lightoven_scene_read_gltf(const char *path,
                                          const struct LightovenGltf *gltf,
                                          struct LightovenScene *scene);

// Reads a .gltf or .glb file that is in memory.
//
// `data`: its `size` bytes, at least 1. `name`: that of the scene, UTF-8; NULL: "memory". `folder`: where files lie that it
// refers to, UTF-8; NULL: it may refer to none, and holds its buffers and images itself. `gltf`: NULL for the defaults.
// `scene`: not NULL, written only where the call succeeds.
//
// # Safety
// As `lightoven_scene_read_gltf`; there are `size` bytes at `data`.
LightovenStatus lightoven_scene_read_gltf_memory(const void *data,
                                                 size_t size,
                                                 const char *name,
                                                 const char *folder,
                                                 const struct LightovenGltf *gltf,
                                                 struct LightovenScene *scene);

// Fills in the defaults. `settings`: not NULL; its `struct_size` is set before.
//
// # Safety
// `settings` may be written.
LightovenStatus lightoven_bake_settings_default(struct LightovenBakeSettings *settings);

// Fills in the defaults. `settings`: not NULL; its `struct_size` is set before.
//
// # Safety
// `settings` may be written.
LightovenStatus lightoven_frame_settings_default(struct LightovenFrameSettings *settings);

// Tells what a baker will take, before anything is allocated. `settings`: NULL for the defaults. `estimate`: not NULL; its
// `struct_size` is set before.
//
// # Safety
// `settings` is NULL or as its members say; `estimate` may be written.
LightovenStatus lightoven_estimate_memory(struct LightovenScene scene,
                                          const struct LightovenBakeSettings *settings,
                                          struct LightovenEstimate *estimate);

// Makes a baker. `settings`: NULL for the defaults. `baker`: not NULL, written only where the call succeeds. It waits for the
// device.
//
// # Safety
// `settings` is NULL or as its members say; `baker` may be written; nobody else uses the device's queues meanwhile.
LightovenStatus lightoven_baker_create(struct LightovenGpu gpu,
                                       struct LightovenScene scene,
                                       const struct LightovenBakeSettings *settings,
                                       struct LightovenBaker *baker);

// Destroys a baker, without waiting. Nothing happens for the null handle. IN_USE while another call works on it.
//
// # Safety
// Every frame that it recorded or submitted, and every frame that uses one of its light maps, has finished on the device.
LightovenStatus lightoven_baker_destroy(struct LightovenBaker baker);

// Gives the newest finished light map. `light_map`: not NULL; its `struct_size` is set before. With a scene that stays as it is
// there is one, which `lightoven_baker_read_back` finishes.
//
// # Safety
// `light_map` may be written.
LightovenStatus lightoven_baker_light_map(struct LightovenBaker baker,
                                          struct LightovenLightMap *light_map);

// Copies the light map, gutters filled, to the host: waits for the device; no frame is then under way. `pixels`: room for
// `pixel_count` times four floats, R, G, B and A, `[height][width][4]` from light-map coordinate v = 0; not NULL.
// `pixel_count`: width times height of `lightoven_baker_light_map`, and nothing else.
//
// # Safety
// There is room for so many at `pixels`; nobody else uses the device's queues meanwhile, and no frame is under way.
LightovenStatus lightoven_baker_read_back(struct LightovenBaker baker,
                                          float *pixels,
                                          size_t pixel_count);

// Writes the light map as OpenEXR: R, G, B and A as 32-bit floats, with scene, seed, samples, device and version as attributes.
// It is written beside and renamed: what was there is replaced, and its mode kept, its owner and access lists not. A link is
// followed, even where it leads to nothing yet; what is no file, or a file without a name such as a deleted one, is refused.
// `path`: UTF-8, not NULL. Waits as `lightoven_baker_read_back` does.
//
// # Safety
// `path` ends with a NUL; otherwise as `lightoven_baker_read_back`.
LightovenStatus lightoven_baker_write_exr(struct LightovenBaker baker,
                                          const char *path);

// Writes a picture of the light map for the eye, as 8-bit PNG, its exposure chosen by its 99th percentile. Otherwise as
// `lightoven_baker_write_exr`, links and modes too.
//
// # Safety
// As `lightoven_baker_write_exr`.
LightovenStatus lightoven_baker_write_png(struct LightovenBaker baker, const char *path);

// Tells what has been done so far. `statistics`: not NULL; its `struct_size` is set before.
//
// # Safety
// `statistics` may be written.
LightovenStatus lightoven_baker_statistics(struct LightovenBaker baker, struct LightovenStatistics *statistics);

// Gives a warning: UTF-8, ended by a NUL, cut short where `capacity` is too small for all of it. `index`: below
// `LightovenStatistics::warning_count`; the other parameters are those of `lightoven_scene_text`.
//
// # Safety
// As `lightoven_scene_text`.
LightovenStatus lightoven_baker_warning(struct LightovenBaker baker,
                                        uint32_t index,
                                        char *buffer,
                                        size_t capacity,
                                        size_t *length);

// Gives what a baker does without, in words, such as "no analytic lights": UTF-8, ended by a NUL, cut short where `capacity` is too small
// for all of it. `index`: below `LightovenStatistics::left_out_count`. `bytes`: set to about what that saves of device memory, 0
// where it saves time alone, or NULL; the other parameters are those of `lightoven_scene_text`, but for
// `buffer` and `length`, which may both be NULL where `bytes` is not.
//
// # Safety
// As `lightoven_scene_text`; `bytes` is NULL or may be written.
LightovenStatus lightoven_baker_left_out(struct LightovenBaker baker,
                                         uint32_t index,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *length,
                                         uint64_t *bytes);

// Tells how a light map is laid out; it stays so. `atlas`: not NULL; its `struct_size` is set before.
//
// # Safety
// `atlas` may be written.
LightovenStatus lightoven_baker_atlas(struct LightovenBaker baker, struct LightovenAtlas *atlas);

// Tells where an instance lies in the light map: what its light-map coordinates are multiplied with and moved by where it is drawn.
// `instance`: below the scene's `instance_count`. `rect`: not NULL; its `struct_size` is set before.
//
// # Safety
// `rect` may be written.
LightovenStatus lightoven_baker_atlas_rect(struct LightovenBaker baker,
                                           uint32_t instance,
                                           struct LightovenAtlasRect *rect);

// Bakes a scene that stays as it is until `stop`, or until `callback` ends it; a later call goes on from there.
//
// `stop`: not NULL. `callback`: NULL for none. `user`: passed to it. `end`: set to a LightovenEnd where the call succeeds, or
// NULL. INVALID_SETTINGS for a stop outside its range, and for one without any limit and without a callback, which would never
// end.
//
// # Safety
// `stop` is as its members say; `callback` may be called with `user`; `end` is NULL or may be written; nobody else uses the
// device's queues meanwhile.
LightovenStatus lightoven_baker_bake(struct LightovenBaker baker,
                                     const struct LightovenStop *stop,
                                     LightovenProgressCallback callback,
                                     void *user,
                                     uint32_t *end);

// `lightoven_baker_bake` for one that looks at the light map on the way, the samples being those of a bake at a stretch: the
// stop's time is what all calls take together, the clock stands still between them, and nothing is said of bounces that are
// missing, for the bake goes on.
//
// # Safety
// As `lightoven_baker_bake`.
LightovenStatus lightoven_baker_bake_until(struct LightovenBaker baker,
                                           const struct LightovenStop *stop,
                                           LightovenProgressCallback callback,
                                           void *user,
                                           uint32_t *end);

// Records a frame's work into the engine's command buffer: about as much as the device does in `budget_ns`, and nothing for 0.
// What the engine records afterwards sees the map that `lightoven_baker_light_map` then gives; drawing that reads it elsewhere
// than in fragment or compute shaders needs a barrier of its own. `report`: filled in, its `struct_size` set before, or NULL.
//
// INVALID_SETTINGS after `lightoven_baker_submit`: a baker stays with one of the two. After UNSUPPORTED or DRIVER from the device
// the baker can only be destroyed.
//
// # Safety
// - The command buffer is primary, of the family of `LightovenGpuDesc::queue`, being recorded, and outside a rendering.
// - Command buffers that one baker recorded into are submitted to that queue once each, in the order of recording. One that is
//   thrown away takes its frame with it: the baker is then to be made anew.
// - `report` is NULL or may be written.
//
// Afterwards pipeline, descriptor sets and push constants are others than before; nothing else is changed.
LightovenStatus lightoven_baker_record(struct LightovenBaker baker,
                                       VkCommandBuffer commands,
                                       uint64_t budget_ns,
                                       struct LightovenFrameReport *report);

// Submits a frame's work to the queue for compute: about as much as the device does in `budget_ns`, and nothing for 0. It
// begins when all of `wait` are reached; all of `signal` follow it, even where there was nothing to do. A map that it finishes is
// given once the frame has been reported complete; a submission that uses the map waits for the frame's `signal`.
//
// `wait`, `signal`: `[wait_count]` and `[signal_count]`, NULL where the count is 0; at most 2^32 - 1 each. `report`: filled in, its
// `struct_size` set before, or NULL. INVALID_SETTINGS after `lightoven_baker_record`. After DEVICE_LOST, OUT_OF_MEMORY or DRIVER
// from the device the baker can only be destroyed.
//
// # Safety
// The semaphores are timeline semaphores of the device and live until the submission is done; a value to wait for is signalled at
// some time, a value to signal is larger than the semaphore's then. Nobody else uses the queue meanwhile. `report` is NULL or may
// be written.
LightovenStatus lightoven_baker_submit(struct LightovenBaker baker,
                                       uint64_t budget_ns,
                                       const struct LightovenTimelinePoint *wait,
                                       size_t wait_count,
                                       const struct LightovenTimelinePoint *signal,
                                       size_t signal_count,
                                       struct LightovenFrameReport *report);

// The engine reports: this frame and all before it have finished on the device, with all that used a light map in them.
// `timing`: filled in, its `struct_size` set before, or NULL.
//
// # Safety
// They have; `timing` is NULL or may be written.
LightovenStatus lightoven_baker_complete(struct LightovenBaker baker,
                                         uint64_t frame,
                                         struct LightovenFrameTiming *timing);

// The time of the next frame, nanoseconds from any beginning, with LIGHTOVEN_CLOCK_ENGINE. Time that runs backwards stands still.
LightovenStatus lightoven_baker_set_time(struct LightovenBaker baker,
                                         uint64_t now_ns);

// Whether the cost model goes on learning from what frames take. `learns`: 1, the default, for budgets that are kept; 0 for equal work with
// equal budgets, whatever that takes.
LightovenStatus lightoven_baker_set_learning(struct LightovenBaker baker,
                                             uint32_t learns);

// Rays that a frame of this budget has for each texel, as far as is known. `samples`: not NULL; 0 for a scene that stays as it is.
//
// # Safety
// `samples` may be written.
LightovenStatus lightoven_baker_samples_per_texel(struct LightovenBaker baker,
                                                  uint64_t budget_ns,
                                                  double *samples);

// Moves an instance that was declared movable. `instance`: below the scene's `instance_count`. `object_to_world`: three rows of
// four, as VkTransformMatrixKHR has them, in double precision; not NULL. Where it has not moved nothing happens. UNSUPPORTED
// where it moves so far away, or shrinks so far beside the scene, that the hierarchy is no longer precise enough: by some 16
// times the scene's half extent.
//
// # Safety
// There are 12 numbers at `object_to_world`.
LightovenStatus lightoven_baker_set_transform(struct LightovenBaker baker,
                                              uint32_t instance,
                                              const double *object_to_world);

// Takes a movable instance out of the scene (`present` 0) or puts it back (1).
LightovenStatus lightoven_baker_set_present(struct LightovenBaker baker, uint32_t instance, uint32_t present);

// Replaces a light; an intensity of 0 switches it off. `index`: below the scene's `light_count`. `light`: not NULL.
// INVALID_SCENE for a value that `lightoven_scene_create` would refuse too.
//
// # Safety
// `light` is as its members say.
LightovenStatus lightoven_baker_set_light(struct LightovenBaker baker,
                                          uint32_t index,
                                          const struct LightovenLight *light);

// Changes what a material emits, before its texture. `material`: below the scene's `material_count`. `radiance`: linear
// Rec. 709, three numbers of at least 0; not NULL.
//
// # Safety
// There are three numbers at `radiance`.
LightovenStatus lightoven_baker_set_emission(struct LightovenBaker baker, uint32_t material, const float *radiance);

// Replaces the sky. A scene that was made with a map takes maps of its size; one without takes none. `sky`: not NULL.
//
// # Safety
// `sky` is as its members say.
LightovenStatus lightoven_baker_set_sky(struct LightovenBaker baker, const struct LightovenSky *sky);

// Takes a scene that has come to need more: its first light, texture or sky map, more lights, an object that begins to move.
// Instances, meshes and light-map coordinates stay as they were. It waits for the device and takes about as long as making the
// baker; the light that has been gathered stays on show. After an error all is as it was.
//
// # Safety
// No frame of the baker is under way; nobody else uses the device's queues meanwhile.
LightovenStatus lightoven_baker_set_scene(struct LightovenBaker baker,
                                          struct LightovenScene scene);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* LIGHTOVEN_H */

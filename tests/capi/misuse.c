/* Every function with NULL, with handles that are none any more, with wrong sizes and counts: a status and a text, no crash. */
#include "scene.h"

#include <pthread.h>

static int rows = 0, wrong = 0;

/* A row of the table: the call, the status that it has to give, and a part of the text. */
static void row(const char *call, LightovenStatus status, LightovenStatus expected, const char *words) {
    const char *text = lightoven_last_error();
    rows++;
    if (status != expected || !strstr(text, words)) {
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

static void devices(Engine *engine) {
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

    LightovenGpu gpu = {0};
    LightovenGpuDesc desc = describe_device(engine, LIGHTOVEN_BACKEND_SOFTWARE);
    const LightovenGpuDesc good = desc;
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
    if (gpu.id != 0) {
        fail("lightoven_gpu_create", "wrote a handle, and failed");
    }

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
    desc = good, desc.pipeline_cache = cache, desc.pipeline_cache_size = size;
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

static void scenes(void) {
    LightovenScene scene = {0};
    LightovenSceneDesc desc = scene_desc;
    REFUSED(lightoven_scene_create(NULL, &scene), INVALID_ARGUMENT, "description of the scene is NULL");
    REFUSED(lightoven_scene_create(&desc, NULL), INVALID_ARGUMENT, "place is NULL");
    WRONG_SIZES(desc, lightoven_scene_create(&desc, &scene));
    WRONG_COUNTS(desc.mesh_count, lightoven_scene_create(&desc, &scene), "mesh is");
    WRONG_COUNTS(desc.instance_count, lightoven_scene_create(&desc, &scene), "instance is");
    WRONG_COUNTS(desc.material_count, lightoven_scene_create(&desc, &scene), "material is");
    WRONG_COUNTS(desc.light_count, lightoven_scene_create(&desc, &scene), "light is");
    WRONG_COUNTS(desc.texture_count, lightoven_scene_create(&desc, &scene), "texture is");
    desc.textures = NULL;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "list of texture is NULL");
    desc = scene_desc, desc.meshes = NULL;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "list of mesh is NULL");
    desc = scene_desc, desc.name = "\xff";
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "name is not UTF-8");
    desc = scene_desc, desc.mesh_count = 0;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "mesh 0; the scene has 0");
    desc = scene_desc, desc.material_count = 0;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "material");

    LightovenMeshPart part = floor_part[0];
    LightovenMesh mesh = {sizeof mesh, "floor", &part, 1};
    desc = scene_desc, desc.meshes = &mesh, desc.mesh_count = 1, desc.instance_count = 1;
    WRONG_SIZES(part, lightoven_scene_create(&desc, &scene));
    WRONG_COUNTS(part.vertex_count, lightoven_scene_create(&desc, &scene), "positions is");
    WRONG_COUNTS(part.index_count, lightoven_scene_create(&desc, &scene), "indices is");
    WRONG_COUNTS(mesh.part_count, lightoven_scene_create(&desc, &scene), "part is");
    WRONG_SIZES(mesh, lightoven_scene_create(&desc, &scene));
    part.reserved = 3;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "'reserved' of mesh 0, part 0 is 3");
    part.positions = NULL, part.reserved = 0;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "list of positions is NULL");
    part = floor_part[0], part.indices = NULL;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "indices is NULL");
    part = floor_part[0], part.vertex_count = 3;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "'floor'");
    part = floor_part[0], part.index_count = 5;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "'floor'");

    LightovenMaterial material = materials[0];
    LightovenTextureUse used = {sizeof used, 0, 0, 9, 0};
    desc = scene_desc, desc.materials = &material, material.albedo_texture = &used;
    WRONG_SIZES(used, lightoven_scene_create(&desc, &scene));
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "wrap is 9");
    used.reserved = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "'reserved' of a material's texture is 1");
    WRONG_SIZES(material, lightoven_scene_create(&desc, &scene));
    material = materials[0], material.reserved = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "'reserved' of material 0 is 1");
    material = materials[0], material.sidedness = 2;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "sidedness is 2");
    LightovenTexture texture = {sizeof texture, "none", NULL, UINT32_MAX, UINT32_MAX};
    desc = scene_desc, desc.textures = &texture, desc.texture_count = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "pixels of texture 0 is NULL");
    WRONG_SIZES(texture, lightoven_scene_create(&desc, &scene));
    texture.pixels = (const uint8_t *)"";
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "pixels of texture 0 is 18446744065119617025");
    texture.width = 0;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "'none' is 0 x");
    LightovenSky sky = {sizeof sky, NULL, 4, 4, {1, 1, 1}, LIGHTOVEN_SKY_KIND_MAP};
    desc = scene_desc, desc.sky = &sky;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "sky map is NULL");
    WRONG_SIZES(sky, lightoven_scene_create(&desc, &scene));
    sky.pixels = (const float *)floor_positions, sky.width = sky.height = UINT32_MAX;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "pixels of the sky map is 18446744065119617025");
    sky.kind = 3;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "kind of the sky is 3");
    LightovenLight light = lights[0];
    desc = scene_desc, desc.lights = &light, light.kind = 8;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "kind of a light is 8");
    WRONG_SIZES(light, lightoven_scene_create(&desc, &scene));
    LightovenInstance odd[2] = {instances[0], instances[1]};
    odd[1].struct_size -= 8;
    desc = scene_desc, desc.instances = odd, desc.instance_count = 2;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "the size of instance 1");

    SIZED(LightovenGltf, gltf);
    REFUSED(lightoven_scene_read_gltf(NULL, NULL, &scene), INVALID_ARGUMENT, "path is NULL");
    REFUSED(lightoven_scene_read_gltf("there is none.gltf", NULL, &scene), IO, "there is none.gltf");
    REFUSED(lightoven_scene_read_gltf("none.gltf", NULL, NULL), INVALID_ARGUMENT, "place is NULL");
    WRONG_SIZES(gltf, lightoven_scene_read_gltf("none.gltf", &gltf, &scene));
    gltf.reserved = 9;
    REFUSED(lightoven_scene_read_gltf("none.gltf", &gltf, &scene), INVALID_ARGUMENT, "'reserved' of the settings is 9");
    gltf.reserved = 0;
    const char *text = "{}";
    REFUSED(lightoven_scene_read_gltf_memory(NULL, 2, NULL, NULL, NULL, &scene), INVALID_ARGUMENT, "file is NULL");
    REFUSED(lightoven_scene_read_gltf_memory(NULL, 0, NULL, NULL, NULL, &scene), INVALID_SCENE, "'memory' is not glTF");
    REFUSED(lightoven_scene_read_gltf_memory(text, 2, "odd", NULL, NULL, &scene), INVALID_SCENE, "'odd' is not glTF");
    REFUSED(lightoven_scene_read_gltf_memory(text, 2, NULL, NULL, NULL, NULL), INVALID_ARGUMENT, "place is NULL");
    size_t bytes = 2;
    WRONG_COUNTS(bytes, lightoven_scene_read_gltf_memory(text, bytes, NULL, NULL, NULL, &scene), "bytes of the file");
    WRONG_SIZES(gltf, lightoven_scene_read_gltf_memory(text, 2, NULL, NULL, &gltf, &scene));
    const char *outside = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"a.bin\"}]}";
    REFUSED(lightoven_scene_read_gltf_memory(outside, strlen(outside), NULL, NULL, NULL, &scene), INVALID_SCENE,
            "'a.bin' names a file");
    if (scene.id != 0) {
        fail("a scene", "was written, and failed");
    }

    WORKS(lightoven_scene_create(&scene_desc, &scene));
    SIZED(LightovenSceneInfo, info);
    REFUSED(lightoven_scene_info(scene, NULL), INVALID_ARGUMENT, "info is NULL");
    WRONG_SIZES(info, lightoven_scene_info(scene, &info));
    char name[4];
    size_t length = 0;
    REFUSED(lightoven_scene_text(scene, 4, 0, name, 4, &length), INVALID_ARGUMENT, "kind of text is 4");
    REFUSED(lightoven_scene_text(scene, LIGHTOVEN_SCENE_TEXT_LIGHT, 3, name, 4, &length), INVALID_ARGUMENT,
            "no light 3: the scene has 3");
    REFUSED(lightoven_scene_text(scene, 0, 0, NULL, 4, NULL), INVALID_ARGUMENT, "both");
    WORKS(lightoven_scene_text(scene, LIGHTOVEN_SCENE_TEXT_INSTANCE, 2, name, sizeof name, &length));
    if (strcmp(name, "squ") != 0 || length != 6) {
        fail("lightoven_scene_text", name);
    }
    WORKS(lightoven_scene_text(scene, LIGHTOVEN_SCENE_TEXT_INSTANCE, 2, name, 0, NULL));
    WORKS(lightoven_scene_destroy(scene));
    REFUSED(lightoven_scene_destroy(scene), INVALID_ARGUMENT, "there is no scene");
    REFUSED(lightoven_scene_info(scene, &info), INVALID_ARGUMENT, "was destroyed");
    uint64_t estimate = 0;
    REFUSED(lightoven_estimate_memory(scene, NULL, &estimate), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_scene_text(scene, 0, 0, name, 4, NULL), INVALID_ARGUMENT, "was destroyed");
}

typedef struct Within {
    LightovenBaker baker;
    LightovenStatus inside, elsewhere;
    int text_is_its_own;
} Within;

static void *elsewhere(void *pointer) {
    Within *within = pointer;
    SIZED(LightovenStatistics, statistics);
    within->text_is_its_own = strcmp(lightoven_last_error(), "") == 0;
    within->elsewhere = lightoven_baker_statistics(within->baker, &statistics);
    return NULL;
}

/* Another call on the same baker, by the same thread and by another. */
static int32_t call_again(const LightovenProgress *progress, void *pointer) {
    (void)progress;
    Within *within = pointer;
    within->inside = lightoven_baker_destroy(within->baker);
    pthread_t thread;
    if (pthread_create(&thread, NULL, elsewhere, within) != 0 || pthread_join(thread, NULL) != 0) {
        fail("pthread_create", "failed");
    }
    return 1;
}

static void settings_are_checked(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    const LightovenScene no_scene = {0};
    uint64_t bytes = 0;
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    REFUSED(lightoven_frame_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(frames, lightoven_frame_settings_default(&frames));
    REFUSED(lightoven_bake_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(settings, lightoven_bake_settings_default(&settings));
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    const LightovenFrameSettings good_frames = frames;
    const LightovenBakeSettings good = settings;
    REFUSED(lightoven_estimate_memory(no_scene, NULL, &bytes), INVALID_ARGUMENT, "scene is the null handle");
    REFUSED(lightoven_estimate_memory(scene, NULL, NULL), INVALID_ARGUMENT, "place is NULL");
    WRONG_SIZES(settings, lightoven_estimate_memory(scene, &settings, &bytes));

    REFUSED(lightoven_baker_create(gpu, scene, NULL, NULL), INVALID_ARGUMENT, "place is NULL");
    REFUSED(lightoven_baker_create(gpu, no_scene, NULL, &baker), INVALID_ARGUMENT, "scene is the null handle");
    const LightovenGpu no_gpu = {scene.id};
    REFUSED(lightoven_baker_create(no_gpu, scene, NULL, &baker), INVALID_ARGUMENT, "there is no GPU");
    LightovenScene gone = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &gone));
    LIGHTOVEN(lightoven_scene_destroy(gone));
    REFUSED(lightoven_baker_create(gpu, gone, NULL, &baker), INVALID_ARGUMENT, "was destroyed");
    WRONG_SIZES(settings, lightoven_baker_create(gpu, scene, &settings, &baker));
    settings.reserved = 4;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_ARGUMENT, "'reserved' of the settings is 4");
#define WITH(member, value, status, words)                                                                             \
    settings = good, settings.member = value;                                                                          \
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), status, words)
    WITH(resolution, 0, INVALID_SETTINGS, "1 to 16384");
    WITH(resolution, UINT32_MAX, INVALID_SETTINGS, "1 to 16384");
    WITH(texels_per_unit, -1, INVALID_SETTINGS, "texels per unit");
    WITH(sampling, 4, INVALID_ARGUMENT, "sampling is 4; allowed is 0 to 3");
    WITH(aimed_by, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    WITH(error, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    settings = good, settings.sampling = LIGHTOVEN_SAMPLING_MIXTURE, settings.cosine_share = 2;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_SETTINGS, "mixture is 2");
    settings = good, settings.frames = &frames, settings.bounces = 2;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_SETTINGS, "bounces");
    settings.bounces = LIGHTOVEN_ALL_BOUNCES;
    WRONG_SIZES(frames, lightoven_baker_create(gpu, scene, &settings, &baker));
#define WITHIN(member, value, status, words)                                                                           \
    frames = good_frames, frames.member = value;                                                                       \
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), status, words)
    WITHIN(decay_threshold, 1, INVALID_SETTINGS, "decay");
    WITHIN(frames_in_flight, 9, INVALID_SETTINGS, "1 to 8");
    WITHIN(clock, 2, INVALID_ARGUMENT, "clock is 2");
    WITHIN(measured_by, 2, INVALID_ARGUMENT, "measured by is 2");
    WITHIN(quanta, 65, INVALID_SETTINGS, "1 to 64");
    if (baker.id != 0) {
        fail("lightoven_baker_create", "wrote a handle, and failed");
    }
}

static void at_a_stretch(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16;
    WORKS(lightoven_baker_create(gpu, scene, &settings, &baker));
    REFUSED(lightoven_gpu_destroy(gpu), IN_USE, "its bakers");
    SIZED(LightovenStop, stop);
    uint32_t end = 7;
    REFUSED(lightoven_baker_bake(baker, NULL, NULL, NULL, NULL), INVALID_ARGUMENT, "stop is NULL");
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "never end");
    WRONG_SIZES(stop, lightoven_baker_bake(baker, &stop, NULL, NULL, &end));
    stop.error = -1;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "error to reach is -1");
    stop.error = 0, stop.samples = UINT32_MAX;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "samples is 4294967295");
    stop.samples = 64;
    Within within = {baker, LIGHTOVEN_STATUS_OK, LIGHTOVEN_STATUS_OK, 0};
    WORKS(lightoven_baker_bake(baker, &stop, call_again, &within, &end));
    if (end != LIGHTOVEN_END_INTERRUPTED || within.inside != LIGHTOVEN_STATUS_IN_USE ||
        within.elsewhere != LIGHTOVEN_STATUS_IN_USE || !within.text_is_its_own ||
        !strstr(lightoven_last_error(), "in use by another call")) {
        fail("a call within a call", lightoven_last_error());
    }

    SIZED(LightovenLightMap, map);
    SIZED(LightovenStatistics, statistics);
    float pixels[16 * 16 * 4];
    REFUSED(lightoven_baker_light_map(baker, NULL), INVALID_ARGUMENT, "light map is NULL");
    WRONG_SIZES(map, lightoven_baker_light_map(baker, &map));
    SIZED(LightovenAtlas, atlas);
    SIZED(LightovenAtlasRect, rect);
    REFUSED(lightoven_baker_atlas(baker, NULL), INVALID_ARGUMENT, "atlas is NULL");
    WRONG_SIZES(atlas, lightoven_baker_atlas(baker, &atlas));
    REFUSED(lightoven_baker_atlas_rect(baker, 0, NULL), INVALID_ARGUMENT, "rectangle is NULL");
    REFUSED(lightoven_baker_atlas_rect(baker, 3, &rect), INVALID_ARGUMENT, "no instance 3: the scene has 3");
    WRONG_SIZES(rect, lightoven_baker_atlas_rect(baker, 0, &rect));
    REFUSED(lightoven_baker_statistics(baker, NULL), INVALID_ARGUMENT, "statistics is NULL");
    WRONG_SIZES(statistics, lightoven_baker_statistics(baker, &statistics));
    REFUSED(lightoven_baker_warning(baker, 1000, NULL, 0, NULL), INVALID_ARGUMENT, "there is no warning 1000");
    REFUSED(lightoven_baker_read_back(baker, NULL, 256), INVALID_ARGUMENT, "pixels is NULL");
    REFUSED(lightoven_baker_read_back(baker, pixels, 0), INVALID_ARGUMENT, "0; allowed is 16 x 16 = 256");
    REFUSED(lightoven_baker_read_back(baker, pixels, SIZE_MAX), INVALID_ARGUMENT, "18446744073709551615; allowed");
    REFUSED(lightoven_baker_write_exr(baker, NULL), INVALID_ARGUMENT, "path is NULL");
    REFUSED(lightoven_baker_write_exr(baker, "no/folder/a.exr"), IO, "no/folder");
    REFUSED(lightoven_baker_write_exr(baker, "\xc3\x28"), INVALID_ARGUMENT, "not UTF-8");
    REFUSED(lightoven_baker_write_png(baker, NULL), INVALID_ARGUMENT, "path is NULL");
    REFUSED(lightoven_baker_write_png(baker, ""), IO, "''");
    /* What only frames have. */
    const double at[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    REFUSED(lightoven_baker_set_transform(baker, 2, at), INVALID_SETTINGS, "Mode::Frames");
    REFUSED(lightoven_baker_set_time(baker, 1), INVALID_SETTINGS, "Mode::Frames");
    REFUSED(lightoven_baker_set_learning(baker, 1), INVALID_SETTINGS, "Mode::Frames");
    REFUSED(lightoven_baker_complete(baker, 1, NULL), INVALID_SETTINGS, "Mode::Frames");
    WORKS(lightoven_baker_destroy(baker));
    const LightovenBaker null = {0};
    WORKS(lightoven_baker_destroy(null));
    REFUSED(lightoven_baker_destroy(baker), INVALID_ARGUMENT, "there is no baker");
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_light_map(baker, &map), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_statistics(baker, &statistics), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_atlas(baker, &atlas), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_atlas_rect(baker, 0, &rect), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_warning(baker, 0, NULL, 0, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_read_back(baker, pixels, 256), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_write_exr(baker, "a.exr"), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_write_png(baker, "a.png"), INVALID_ARGUMENT, "was destroyed");
}

static void within_frames(Engine *engine, LightovenScene scene) {
    LightovenBaker baker = {0};
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16, settings.frames = &frames;
    WORKS(lightoven_baker_create(engine->gpu, scene, &settings, &baker));
    SIZED(LightovenFrameReport, report);
    SIZED(LightovenFrameTiming, timing);
    REFUSED(lightoven_baker_record(baker, NULL, 1, &report), INVALID_ARGUMENT, "command buffer is VK_NULL_HANDLE");
    WRONG_SIZES(report, lightoven_baker_record(baker, engine->commands, 1, &report));
    SIZED(LightovenTimelinePoint, point);
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 1, NULL, 0, NULL), INVALID_ARGUMENT, "point to wait for is NULL");
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 0, &point, 1, NULL), INVALID_ARGUMENT, "signal 0 is VK_NULL_HANDLE");
    size_t count = 1;
    WRONG_COUNTS(count, lightoven_baker_submit(baker, 1, &point, count, NULL, 0, NULL), "point to wait for is");
    WRONG_COUNTS(count, lightoven_baker_submit(baker, 1, NULL, 0, &point, count, NULL), "point to signal is");
    WRONG_SIZES(point, lightoven_baker_submit(baker, 1, &point, 1, NULL, 0, NULL));
    WRONG_SIZES(report, lightoven_baker_submit(baker, 1, NULL, 0, NULL, 0, &report));
    REFUSED(lightoven_baker_complete(baker, 99, NULL), INVALID_SETTINGS, "99");
    SIZED(LightovenStop, stop);
    stop.samples = 1;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, NULL), INVALID_SETTINGS, "Mode::Still");

    const double flat[12] = {0}, at[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const float dark[3] = {-1, 0, 0};
    LightovenLight light = lights[0];
    LightovenSky sky = {sizeof sky, NULL, 0, 0, {1, 1, 1}, LIGHTOVEN_SKY_KIND_CONSTANT};
    REFUSED(lightoven_baker_set_transform(baker, 2, NULL), INVALID_ARGUMENT, "transform is NULL");
    REFUSED(lightoven_baker_set_transform(baker, 2, flat), INVALID_SETTINGS, "invertible");
    REFUSED(lightoven_baker_set_transform(baker, 0, at), INVALID_SETTINGS, "declared static");
    REFUSED(lightoven_baker_set_transform(baker, UINT32_MAX, at), INVALID_SETTINGS, "4294967295");
    REFUSED(lightoven_baker_set_present(baker, 2, 2), INVALID_ARGUMENT, "is 2; allowed is 0 to 1");
    REFUSED(lightoven_baker_set_present(baker, 9, 0), INVALID_SETTINGS, "9");
    REFUSED(lightoven_baker_set_light(baker, 0, NULL), INVALID_ARGUMENT, "light is NULL");
    WRONG_SIZES(light, lightoven_baker_set_light(baker, 0, &light));
    REFUSED(lightoven_baker_set_light(baker, 3, &light), INVALID_SETTINGS, "light");
    light.intensity[1] = -1;
    REFUSED(lightoven_baker_set_light(baker, 0, &light), INVALID_SCENE, "intensity of light 'bulb'");
    REFUSED(lightoven_baker_set_emission(baker, 0, NULL), INVALID_ARGUMENT, "radiance is NULL");
    REFUSED(lightoven_baker_set_emission(baker, 0, dark), INVALID_SCENE, "emission");
    REFUSED(lightoven_baker_set_emission(baker, 3, (const float[3]){0}), INVALID_SETTINGS, "3");
    REFUSED(lightoven_baker_set_sky(baker, NULL), INVALID_ARGUMENT, "sky is NULL");
    WRONG_SIZES(sky, lightoven_baker_set_sky(baker, &sky));
    sky.radiance[2] = -1;
    REFUSED(lightoven_baker_set_sky(baker, &sky), INVALID_SCENE, "sky");
    const LightovenScene no_scene = {0};
    REFUSED(lightoven_baker_set_scene(baker, no_scene), INVALID_ARGUMENT, "scene is the null handle");
    LightovenScene gone = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &gone));
    LIGHTOVEN(lightoven_scene_destroy(gone));
    REFUSED(lightoven_baker_set_scene(baker, gone), INVALID_ARGUMENT, "was destroyed");
    double samples = 0;
    REFUSED(lightoven_baker_samples_per_texel(baker, 1, NULL), INVALID_ARGUMENT, "samples' place is NULL");
    WORKS(lightoven_baker_samples_per_texel(baker, 1000000, &samples));
    REFUSED(lightoven_baker_set_learning(baker, 2), INVALID_ARGUMENT, "learning is 2");
    /* Nothing was done by all of these. */
    report = record_frame(engine, baker, 0);
    WRONG_SIZES(timing, lightoven_baker_complete(baker, report.frame, &timing));
    WORKS(lightoven_baker_complete(baker, report.frame, &timing));
    if (report.frame != 1 || report.rays != 0) {
        fail("frames", "were begun by calls that were refused");
    }
    WORKS(lightoven_baker_destroy(baker));
    REFUSED(lightoven_baker_record(baker, engine->commands, 1, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 0, NULL, 0, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_complete(baker, 1, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_transform(baker, 2, at), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_present(baker, 2, 1), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_light(baker, 0, &lights[0]), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_emission(baker, 0, (const float[3]){0}), INVALID_ARGUMENT, "was destroyed");
    sky.radiance[2] = 1;
    REFUSED(lightoven_baker_set_sky(baker, &sky), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_scene(baker, scene), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_samples_per_texel(baker, 1, &samples), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_time(baker, 1), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_learning(baker, 1), INVALID_ARGUMENT, "was destroyed");
}

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

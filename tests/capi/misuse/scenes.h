/* Scenes, from arrays and from glTF. */
#ifndef SCENES_H
#define SCENES_H

#include "table.h"

#include <float.h>
#include <math.h>

static void is_null(LightovenScene scene) {
    if (scene.id != 0) {
        fail("a scene", "was written, and failed");
    }
}

static void lists_of_scenes(void) {
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
    is_null(scene);
}

static void meshes_are_checked(void) {
    LightovenScene scene = {0};
    LightovenMeshPart part = floor_part[0];
    LightovenMesh mesh = {sizeof mesh, "floor", &part, 1};
    LightovenSceneDesc desc = scene_desc;
    desc.meshes = &mesh, desc.mesh_count = 1, desc.instance_count = 1;
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
    is_null(scene);
}

static void materials_are_checked(void) {
    LightovenScene scene = {0};
    LightovenMaterial material = materials[0];
    LightovenTextureUse used = {sizeof used, 0, 0, 9, 0};
    LightovenSceneDesc desc = scene_desc;
    desc.materials = &material, material.albedo_texture = &used;
    WRONG_SIZES(used, lightoven_scene_create(&desc, &scene));
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "wrap is 9");
    used.reserved = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "'reserved' of a material's texture is 1");
    WRONG_SIZES(material, lightoven_scene_create(&desc, &scene));
    material = materials[0], material.reserved = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "'reserved' of material 0 is 1");
    material = materials[0], material.sidedness = 2;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "sidedness is 2");
    material = materials[2], material.albedo[0] = NAN, material.albedo[1] = -1;
    desc.material_count = 1;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "albedo of material 'square'");
    is_null(scene);
}

static void pixels_are_checked(void) {
    LightovenScene scene = {0};
    LightovenSceneDesc desc = scene_desc;
    LightovenTexture texture = {sizeof texture, "none", NULL, UINT32_MAX, UINT32_MAX};
    desc.textures = &texture, desc.texture_count = 1;
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
    is_null(scene);
}

static void lights_and_instances_are_checked(void) {
    LightovenScene scene = {0};
    LightovenLight light = lights[0];
    LightovenSceneDesc desc = scene_desc;
    desc.lights = &light, light.kind = 8;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "kind of a light is 8");
    WRONG_SIZES(light, lightoven_scene_create(&desc, &scene));
    desc.light_count = 1, light = lights[2], light.direction[0] = HUGE_VALF;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_SCENE, "direction of light 'sun' is [inf, 2, -4]; allowed is any");
    light.direction[0] = FLT_MAX;
    WORKS(lightoven_scene_create(&desc, &scene));
    WORKS(lightoven_scene_destroy(scene));
    scene.id = 0;
    LightovenInstance odd[2] = {instances[0], instances[1]};
    odd[1].struct_size -= 8;
    desc = scene_desc, desc.instances = odd, desc.instance_count = 2;
    REFUSED(lightoven_scene_create(&desc, &scene), INVALID_ARGUMENT, "the size of instance 1");
    is_null(scene);
}

static void gltf_is_checked(void) {
    LightovenScene scene = {0};
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
    is_null(scene);
}

static void scenes_are_used(void) {
    LightovenScene scene = {0};
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
    SIZED(LightovenEstimate, estimate);
    REFUSED(lightoven_estimate_memory(scene, NULL, &estimate), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_scene_text(scene, 0, 0, name, 4, NULL), INVALID_ARGUMENT, "was destroyed");
}

static void scenes(void) {
    lists_of_scenes();
    meshes_are_checked();
    materials_are_checked();
    pixels_are_checked();
    lights_and_instances_are_checked();
    gltf_is_checked();
    scenes_are_used();
}

#endif

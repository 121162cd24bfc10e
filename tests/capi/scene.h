/* The scene of the tests' engines: a floor under a lamp, lights of every kind and a sky, and a square between them that moves. The
 * same numbers are in reference.rs. */
#ifndef SCENE_H
#define SCENE_H

#include "engine.h"

static const float floor_positions[] = {-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0};
static const float floor_normals[] = {0, .1f, 2, 0, .1f, 2, 0, -.1f, 2, 0, -.1f, 2};
static const float floor_uvs[] = {.02f, .02f, .48f, .02f, .48f, .48f, .02f, .48f};
static const float lamp_positions[] = {-1, -1, 3, -1, 1, 3, 1, 1, 3, 1, -1, 3};
static const float lamp_uvs[] = {.52f, .02f, .98f, .02f, .98f, .48f, .52f, .48f};
static const float square_positions[] = {-.6f, -.6f, 0, .6f, -.6f, 0, .6f, .6f, 0, -.6f, .6f, 0};
static const float square_uvs[] = {.02f, .52f, .48f, .52f, .48f, .98f, .02f, .98f};
static const float once[] = {0, 0, 1, 0, 1, 1, 0, 1};
static const float twice[] = {0, 0, 2, 0, 2, 3, 0, 3};
static const uint32_t quad_indices[] = {0, 1, 2, 0, 2, 3};

#define PART(name, normals, albedo_uvs, emission_uvs, index)                                                           \
    { sizeof(LightovenMeshPart), name##_positions, normals, name##_uvs, albedo_uvs, emission_uvs, 4, quad_indices, 6,  \
      index, 0 }

static const LightovenMeshPart floor_part[] = {PART(floor, floor_normals, twice, once, 0)};
static const LightovenMeshPart lamp_part[] = {PART(lamp, 0, once, twice, 1)};
static const LightovenMeshPart square_part[] = {PART(square, 0, 0, 0, 2)};

static const LightovenMesh meshes[] = {
    {sizeof(LightovenMesh), "floor", floor_part, 1},
    {sizeof(LightovenMesh), "lamp", lamp_part, 1},
    {sizeof(LightovenMesh), "square", square_part, 1},
};

static const double square_at[] = {1, 0, 0, -.5, 0, 1, 0, 0, 0, 0, 1, 1};
static const LightovenInstance instances[] = {
    {sizeof(LightovenInstance), "floor", 0, 0, LIGHTOVEN_MOBILITY_STATIC},
    {sizeof(LightovenInstance), "lamp", 0, 1, LIGHTOVEN_MOBILITY_STATIC},
    {sizeof(LightovenInstance), "square", square_at, 2, LIGHTOVEN_MOBILITY_MOVABLE},
};

static const uint8_t pixels[] = {255, 200, 150, 255, 90, 60, 30, 255, 10, 240, 120, 255, 200, 100, 220, 255};
static const LightovenTexture textures[] = {{sizeof(LightovenTexture), "tiles", pixels, 2, 2}};
static const LightovenTextureUse on_floor = {sizeof on_floor, 0, LIGHTOVEN_WRAP_REPEAT, LIGHTOVEN_WRAP_MIRRORED_REPEAT, 0};
static const LightovenTextureUse on_lamp = {sizeof on_lamp, 0, LIGHTOVEN_WRAP_CLAMP_TO_EDGE, LIGHTOVEN_WRAP_REPEAT, 0};

static const LightovenMaterial materials[] = {
    {sizeof(LightovenMaterial), "floor", &on_floor, 0, {.5f, .6f, .7f}, {0, 0, 0}, LIGHTOVEN_SIDEDNESS_SINGLE, 0},
    {sizeof(LightovenMaterial), "lamp", 0, &on_lamp, {.1f, .1f, .1f}, {4, 5, 6}, LIGHTOVEN_SIDEDNESS_SINGLE, 0},
    {sizeof(LightovenMaterial), "square", 0, 0, {.8f, .4f, .2f}, {0, 0, 0}, LIGHTOVEN_SIDEDNESS_DOUBLE, 0},
};

#define LIGHT(name, x, y, z, dx, dy, dz, r, g, b, range, inner, outer, kind)                                           \
    { sizeof(LightovenLight), name, {x, y, z}, {dx, dy, dz}, {r, g, b}, range, inner, outer, kind }

static const LightovenLight lights[] = {
    LIGHT("bulb", 1, 1, 2, 0, 0, 0, 3, 2, 1, 9, 0, 0, LIGHTOVEN_LIGHT_KIND_POINT),
    LIGHT("lantern", -1.5, -1, 2, .5f, .25f, -2, 5, 6, 7, 0, .25f, .75f, LIGHTOVEN_LIGHT_KIND_SPOT),
    LIGHT("sun", 0, 0, 0, 1, 2, -4, .5f, .4f, .3f, 0, 0, 0, LIGHTOVEN_LIGHT_KIND_DIRECTIONAL),
};

static const float sky_pixels[] = {.1f, .2f, .3f, .2f, .3f, .4f, .3f, .4f, .5f, .4f, .5f, .6f,
                                   .5f, .4f, .3f, .4f, .3f, .2f, .3f, .2f, .1f, .2f, .1f, 0};
static const float night_pixels[] = {0, 0, .1f, 0, 0, .2f, 0, 0, .3f, 0, 0, .2f, 0, 0, .1f, 0, 0, .1f, 0, 0, .1f, 0, 0, .1f};

#define SKY(pixels) {sizeof(LightovenSky), pixels, 4, 2, {0, 0, 0}, LIGHTOVEN_SKY_KIND_MAP}

static const LightovenSky day = SKY(sky_pixels), night = SKY(night_pixels);

static const LightovenSceneDesc scene_desc = {
    sizeof(LightovenSceneDesc), "room", meshes, 3, instances, 3, materials, 3, textures, 1, lights, 3, &day,
};

/* What changes before a frame. */
static inline void change_scene(LightovenBaker baker, int frame) {
    const double placed[] = {1, 0, 0, -.5 + frame / 32., 0, 1, 0, 0, 0, 0, 1, 1};
    LIGHTOVEN(lightoven_baker_set_transform(baker, 2, placed));
    if (frame == 6) {
        const LightovenLight narrower =
            LIGHT("lantern", -1.5, -1, 2, .5f, .25f, -2, 9, 6, 3, 0, .125f, .5f, LIGHTOVEN_LIGHT_KIND_SPOT);
        LIGHTOVEN(lightoven_baker_set_light(baker, 1, &narrower));
    }
    if (frame == 9) {
        const float radiance[] = {8, 2, 1};
        LIGHTOVEN(lightoven_baker_set_emission(baker, 1, radiance));
    }
    if (frame == 12) {
        LIGHTOVEN(lightoven_baker_set_sky(baker, &night));
    }
    if (frame == 18 || frame == 24) {
        LIGHTOVEN(lightoven_baker_set_present(baker, 2, frame == 24));
    }
    LIGHTOVEN(lightoven_baker_set_time(baker, (uint64_t)frame * 16000000));
}

#endif

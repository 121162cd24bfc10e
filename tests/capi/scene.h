/* The scene of the tests' engines: a floor under a lamp and a point light, and a square between them that moves. The same numbers
 * are in reference.rs. */
#ifndef SCENE_H
#define SCENE_H

#include <lightoven.h>

static const float floor_positions[] = {-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0};
static const float floor_uvs[] = {.02f, .02f, .48f, .02f, .48f, .48f, .02f, .48f};
static const float lamp_positions[] = {-1, -1, 3, -1, 1, 3, 1, 1, 3, 1, -1, 3};
static const float lamp_uvs[] = {.52f, .02f, .98f, .02f, .98f, .48f, .52f, .48f};
static const float square_positions[] = {-.6f, -.6f, 0, .6f, -.6f, 0, .6f, .6f, 0, -.6f, .6f, 0};
static const float square_uvs[] = {.02f, .52f, .48f, .52f, .48f, .98f, .02f, .98f};
static const uint32_t quad_indices[] = {0, 1, 2, 0, 2, 3};

#define PART(name, index)                                                                                              \
    { sizeof(LightovenMeshPart), name##_positions, 0, name##_uvs, 0, 0, 4, quad_indices, 6, index, 0 }

static const LightovenMeshPart floor_part[] = {PART(floor, 0)};
static const LightovenMeshPart lamp_part[] = {PART(lamp, 1)};
static const LightovenMeshPart square_part[] = {PART(square, 2)};

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

static const LightovenMaterial materials[] = {
    {sizeof(LightovenMaterial), "floor", 0, 0, {.5f, .6f, .7f}, {0, 0, 0}, LIGHTOVEN_SIDEDNESS_SINGLE, 0},
    {sizeof(LightovenMaterial), "lamp", 0, 0, {0, 0, 0}, {4, 5, 6}, LIGHTOVEN_SIDEDNESS_SINGLE, 0},
    {sizeof(LightovenMaterial), "square", 0, 0, {.8f, .4f, .2f}, {0, 0, 0}, LIGHTOVEN_SIDEDNESS_DOUBLE, 0},
};

static const LightovenLight lights[] = {
    {sizeof(LightovenLight), "bulb", {1, 1, 2}, {0, 0, 0}, {3, 3, 3}, 0, 0, 0, LIGHTOVEN_LIGHT_KIND_POINT},
};

static const LightovenSceneDesc scene_desc = {
    sizeof(LightovenSceneDesc), "room", meshes, 3, instances, 3, materials, 3, 0, 0, lights, 1, 0,
};

#endif

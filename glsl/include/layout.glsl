// What host and device share: structs (std430), bindings, specialisation constants, push constants.
// Written again in Rust (src/gpu/layout.rs, src/bvh); src/gpu/layout/tests.rs compares the two.
#ifndef LAYOUT_GLSL
#define LAYOUT_GLSL

// Children's boxes and codes: src/bvh/encode.rs. In xyz the bits of floats, in w of lo0 and hi0 the children's codes.
struct Node {
    uvec4 lo0;
    uvec4 hi0;
    uvec4 lo1;
    uvec4 hi1;
};

// Object-space corners; w is not used.
struct Triangle {
    vec4 corners[3];
};

// What a hit needs of a triangle. `uvs`: light-map coordinates. `normals`: octahedral, two snorm16. `sheet`: the same
// for triangles of a mesh on which light-map coordinates and positions are one affine map.
struct Primitive {
    vec2 uvs[3];
    uint normals[3];
    uint material;
    uint flags;
    uint sheet;
};

struct Material {
    vec3 albedo;
    uint pad0;
    vec3 emission;
    uint pad1;
};

// Rows of the transforms. `atlas`: texel = light-map coordinate * xy + zw.
struct Instance {
    vec4 object_to_world[3];
    vec4 world_to_object[3];
    uint root;
    uint first_primitive;
    uint flags;
    uint pad;
    vec4 atlas;
};

// `direction`: the way the light travels. `range`: 0 = none. Cone: saturate(cos * scale + offset)^2.
struct Light {
    vec3 position;
    uint kind;
    vec3 direction;
    float range;
    vec3 intensity;
    float cone_scale;
    float cone_offset;
    uint pad0;
    uint pad1;
    uint pad2;
};

// A primitive as an instance has it, and how far its sheet reaches within a texel: least and greatest x and y, two unorm16
// each, or 0 where the primitive's own bounds tell.
struct Piece {
    uint instance;
    uint primitive;
    uint lo;
    uint hi;
};

// Texels that rays are aimed at together. Of what shines: `centre`, its mean place; `spread`, the root of the mean squared
// distance from there; `axis`, the mean normal, where it shines to the front alone; `even`, what shines whichever way.
struct Cluster {
    vec3 centre;
    float spread;
    vec3 axis;
    float even;
    float power;  // luminance times area
    uint first;   // in the list of clusters' texels
    uint count;
    uint pad0;
};

// Where a ray of a bounce epoch ended: its texel, x in the lower half, and what that texel's radiance counts there.
struct Link {
    uint texel;
    float weight;
};

const uint PRIMITIVE_MAPPED = 1u;
const uint PRIMITIVE_DOUBLE_SIDED = 2u;

const uint INSTANCE_ABSENT = 2u;
const uint INSTANCE_MOVABLE = 4u;

const uint LIGHT_POINT = 0u;
const uint LIGHT_SPOT = 1u;
const uint LIGHT_DIRECTIONAL = 2u;

const float PI = 3.14159265358979;

layout(constant_id = 0) const uint FEATURES = 0xffffffffu;
layout(constant_id = 1) const uint STACK_SIZE = 64u;
layout(constant_id = 3) const bool TEXEL_BUFFERS = false; // whether the hierarchy is read as texels

// Bits of FEATURES, in the order of src/features.rs.
const bool INSTANCES = (FEATURES & 1u) != 0u;         // a top level over more than one mesh placement
const bool SINGLE_SIDED = (FEATURES & 2u) != 0u;      // some surface is black from behind
const bool UNMAPPED = (FEATURES & 4u) != 0u;          // some triangle has no place in the light map
const bool SKY_MAP = (FEATURES & 8u) != 0u;
const bool LIGHTS = (FEATURES & 16u) != 0u;
const bool ALBEDO_TEXTURES = (FEATURES & 32u) != 0u;  // albedo differs within a surface of the light map
const bool EMISSION_TEXTURES = (FEATURES & 64u) != 0u;
const bool DYNAMIC = (FEATURES & 128u) != 0u;         // the light map follows a scene that changes
const bool IMPORTANCE = (FEATURES & 256u) != 0u;      // rays are aimed at light as well
const bool SHARED_TEXELS = (FEATURES & 512u) != 0u;   // something that emits shares a texel with another surface
const bool CLUSTERS = (FEATURES & 1024u) != 0u;       // rays are aimed by distance as well
const bool VISIBILITY = (FEATURES & 2048u) != 0u;     // and by what has been seen
const bool LINKS = (FEATURES & 4096u) != 0u;          // light goes again along rays that are kept
const bool HALVES = (FEATURES & 8192u) != 0u;         // samples are kept in two halves, which tell the error
const bool GATHERING = (FEATURES & 16384u) != 0u;     // there is light that rays can find

layout(push_constant, std430) uniform Push {
    uvec2 map_size;       // texels
    uint first_texel;     // in the list of texels
    uint texel_count;
    uint first_quantum;
    uint quantum_count;   // importance: 0 = nobody reads its sums
    uint light_count;
    uint root;            // where a ray starts in the hierarchy
    vec3 sky;             // where there is no map of it: the same radiance everywhere, or black
    float origin_offset;  // along the geometric normal, scene units
    uvec2 seed;
    uint instance;        // gbuffer: the instance drawn; importance: 1 = of the sky
    // dilate: how far to look, 0 = fill; emit: from one work group to the next; bake: one in so many tells what it sees, 0 = none
    uint step_texels;
    float mean_luminance; // resolve, bake: of the last estimate
    uint rays;            // bake: of a quantum, those below included
    uint source_rays;     // bake: aimed at the light map
    uint sky_rays;        // bake: aimed at the sky map
    uint evidence_quantum; // bake: which quantum tells of other mixtures
    uint first_level;     // importance: of the pyramid; clusters: which is the first
    uint end_level;
    uint first_sample;    // bake: of quantum 0, for the random numbers
    float history;        // bake, dynamic: what the running average weighs, in quanta
    uint link_stride;     // bake, bounce: from a texel's link to its next one; bake: 0 = none is kept
} push;

#endif

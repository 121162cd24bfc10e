#version 460
// Fills texels without light of their own with that of the nearest one that has some: Rong and Tan, "Jump Flooding in
// GPU", I3D 2006. Step 0 fills; the passes before it look for the nearest, at steps of falling powers of two.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 8, rgba32ui) readonly uniform uimage2D surface_image;
layout(set = 0, binding = 21, rgba32f) uniform image2D light_map;
// The nearest lit texel found so far, x and y in 16 bits each; NOWHERE: none.
layout(set = 0, binding = 22, r32ui) readonly uniform uimage2D nearest_before;
layout(set = 0, binding = 23, r32ui) writeonly uniform uimage2D nearest_after;

const uint NOWHERE = 0xffffffffu;

ivec2 decode(uint code) {
    return ivec2(code & 0xffffu, code >> 16u);
}

// The very first pass knows only of itself.
uint seed_of(ivec2 texel) {
    if (push.first_quantum > 0u) return imageLoad(nearest_before, texel).x;
    return imageLoad(light_map, texel).a > 0.0 ? uint(texel.x | texel.y << 16) : NOWHERE;
}

void flood(ivec2 texel) {
    uint best = NOWHERE;
    int best_distance = 0x7fffffff;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            ivec2 at = texel + ivec2(x, y) * int(push.step_texels);
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(push.map_size)))) continue;
            uint seed = seed_of(at);
            ivec2 way = decode(seed) - texel;
            int squared = way.x * way.x + way.y * way.y;
            if (seed != NOWHERE && squared < best_distance) {
                best = seed;
                best_distance = squared;
            }
        }
    }
    imageStore(nearest_after, texel, uvec4(best));
}

void fill(ivec2 texel) {
    uint nearest = imageLoad(nearest_before, texel).x;
    if (nearest != NOWHERE && decode(nearest) == texel) return;
    float coverage = imageLoad(surface_image, texel).x != 0u ? 1.0 : 0.0;
    vec3 irradiance = nearest == NOWHERE ? vec3(0.0) : imageLoad(light_map, decode(nearest)).rgb;
    imageStore(light_map, texel, vec4(irradiance, coverage));
}

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(texel, push.map_size))) return;
    if (push.step_texels == 0u) fill(ivec2(texel));
    else flood(ivec2(texel));
}

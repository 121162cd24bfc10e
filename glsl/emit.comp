#version 460
// Writes the rays that a bake sends by the cosine, in place of tracing them: for benchmarks, which ask the same of every
// back end. In the order of the bake's work: of a work group's texels first the rays of one stratum, then of the next.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/rays.glsl"
#include "include/random.glsl"
#include "include/sampling.glsl"
#include "include/texels.glsl"
#include "include/mixture.glsl"

layout(set = 0, binding = 9, r32ui) readonly uniform uimage2D footprint_image;
layout(set = 0, binding = 24, std430) writeonly buffer Rays { Ray rays[]; };

// A ray that goes nowhere: the host leaves it out.
const Ray NOWHERE = Ray(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), -1.0, NO_INSTANCE, 0xffffffffu);

void main() {
    uint slot = work_group() * gl_WorkGroupSize.x * push.rays + gl_LocalInvocationID.x;
    // Some work groups of the list are passed over.
    uint place = work_group() * push.step_texels + gl_LocalInvocationID.x;
    bool inside = place < push.texel_count;
    Receiver r;
    if (inside) {
        uint code = texels[push.first_texel + place];
        uvec2 texel = uvec2(code & 0xffffu, code >> 16u);
        r.surface = surface_of(texel, imageLoad(surface_image, ivec2(texel)));
        r.sides = unpack_footprint(imageLoad(footprint_image, ivec2(texel)).x);
        r.frame = frame_of(r.surface.normal);
        r.key = code;
        r.row = 0u;
        r.source_total = 0.0;
        r.sky_total = 0.0;
    }
    for (uint index = 0u; index < push.rays; ++index) {
        Ray ray = NOWHERE;
        Aim aim;
        if (inside && !aim_ray(r, index, push.first_sample + index, ray, aim)) ray = NOWHERE;
        rays[slot + index * gl_WorkGroupSize.x] = ray;
    }
}

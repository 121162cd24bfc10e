#version 460
// Irradiance of every baked texel into the light map, and the error that the half buffers tell.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/texels.glsl"
#include "include/irradiance.glsl"

layout(set = 0, binding = 21, rgba32f) writeonly uniform image2D light_map;
// A work group's sums: luminance, squared relative standard error of the luminance over each field, texels.
layout(set = 0, binding = 20, std430) writeonly buffer Sums { vec4 sums[]; };

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

shared vec4 group[64];

// The luminance's squared standard error, from the difference of the halves, relative as in relMSE. In units of the mean,
// for squares of what is very bright or dark are no numbers.
float relative_error(vec4 even, vec4 odd, float luminance) {
    float count = even.w + odd.w, mean = push.mean_luminance;
    if (even.w == 0.0 || odd.w == 0.0 || !(mean > 0.0)) return 0.0;
    float difference = dot(even.rgb - odd.rgb, LUMINANCE) / mean;
    float relative = luminance / mean;
    return difference * difference * (even.w / count) * (odd.w / count) / (relative * relative + 0.01);
}

void main() {
    uvec2 texel;
    vec4 mine = vec4(0.0);
    if (texel_of_invocation(texel)) {
        vec3 irradiance = shown_irradiance(ivec2(texel));
        float luminance = dot(irradiance, LUMINANCE);
        vec4 even = GATHERING ? imageLoad(mean_even, ivec2(texel)) : vec4(0.0);
        vec4 odd = DYNAMIC || HALVES ? imageLoad(mean_odd, ivec2(texel)) : vec4(0.0);
        // A texel that an interrupted bake has not reached is filled like a gutter.
        bool is_lit = GATHERING ? even.w + odd.w > 0.0 : !LIGHTS || imageLoad(direct_image, ivec2(texel)).a > 0.0;
        float lit = DYNAMIC || is_lit ? 1.0 : 0.0;
        imageStore(light_map, ivec2(texel), vec4(irradiance, lit));
        float error = relative_error(even, odd, luminance);
        mine = field_of_invocation() == 0u ? vec4(luminance, error, 0.0, 1.0) : vec4(luminance, 0.0, error, 1.0);
    }
    uint lane = gl_LocalInvocationID.x;
    group[lane] = mine;
    barrier();
    for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
        if (lane < half_size) group[lane] += group[lane + half_size];
        barrier();
    }
    if (lane == 0u && has_sum()) sums[work_group()] = group[0];
}

#version 460
// The light map that the engine sees, of a dynamic scene: every texel with the irradiance of the texel that is nearest to
// it and takes rays, itself in most cases. Which one that is was found once, by dilate.comp.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/irradiance.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 8, rgba32ui) readonly uniform uimage2D surface_image;
layout(set = 0, binding = 21, rgba32f) writeonly uniform image2D light_map;
layout(set = 0, binding = 22, r32ui) readonly uniform uimage2D nearest_before;

const uint NOWHERE = 0xffffffffu;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy + uvec2(0u, push.first_texel));
    if (any(greaterThanEqual(uvec2(texel), push.map_size))) return;
    uint code = imageLoad(nearest_before, texel).x;
    ivec2 nearest = ivec2(code & 0xffffu, code >> 16u);
    vec3 irradiance = code == NOWHERE ? vec3(0.0) : shown_irradiance(nearest);
    // A light that lies on a surface has no finite answer there.
    if (any(isnan(irradiance)) || any(isinf(irradiance))) irradiance = vec3(0.0);
    float coverage = imageLoad(surface_image, texel).x != 0u ? 1.0 : 0.0;
    imageStore(light_map, texel, vec4(irradiance, coverage));
}

#version 460
// Light goes once more along rays that were traced before: to each texel from those where its rays ended.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/layout.glsl"
#include "include/texels.glsl"
#include "include/links.glsl"

layout(set = 0, binding = 10) uniform texture2D source_map;
layout(set = 0, binding = 11, rgba32f) writeonly uniform image2D mean_even;
// What came from elsewhere than the source map: it stays.
layout(set = 0, binding = 12, rgba32f) readonly uniform image2D mean_odd;

void main() {
    uvec2 texel;
    if (!texel_of_invocation(texel)) return;
    uint place = push.first_texel + index_of_invocation();
    vec3 irradiance = imageLoad(mean_odd, ivec2(texel)).rgb;
    for (uint ray = 0u; ray < push.rays; ++ray) {
        Link link = links[link_place(place, ray)];
        irradiance += texelFetch(source_map, ivec2(link.texel & 0xffffu, link.texel >> 16u), 0).rgb * link.weight;
    }
    imageStore(mean_even, ivec2(texel), vec4(irradiance, float(push.rays)));
}

#version 460
// Outgoing radiance of every texel, albedo / pi * irradiance + emission: what a ray's hit reads. Emission is free. In a
// dynamic scene the hit adds it, see bake.comp.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/surface.glsl"
#include "include/texels.glsl"
#include "include/irradiance.glsl"

layout(set = 0, binding = 17, rgba32f) readonly uniform image2D albedo_image;
layout(set = 0, binding = 18, rgba32f) readonly uniform image2D emission_image;
layout(set = 0, binding = 19, rgba32f) writeonly uniform image2D source_image;
// A work group's sums: luminance times area, area, largest albedo, texels whose radiance was no number.
layout(set = 0, binding = 20, std430) writeonly buffer Sums { vec4 sums[]; };

// From NUMERICS: an albedo of 1 has no finite answer in a closed room. Scene::MAX_ALBEDO.
const float MAX_ALBEDO = 0.999;

shared vec4 group[64];

void main() {
    uvec2 texel;
    vec4 mine = vec4(0.0);
    if (texel_of_invocation(texel)) {
        uvec4 g = imageLoad(surface_image, ivec2(texel));
        Material material = materials[primitives[g.y].material];
        vec3 albedo = material.albedo * (ALBEDO_TEXTURES ? imageLoad(albedo_image, ivec2(texel)).rgb : vec3(1.0));
        albedo = min(albedo, vec3(MAX_ALBEDO));
        vec3 radiance = albedo * reflected_irradiance(ivec2(texel)) / PI;
        if (!DYNAMIC) {
            radiance += material.emission * (EMISSION_TEXTURES ? imageLoad(emission_image, ivec2(texel)).rgb : vec3(1.0));
        }
        bool valid = !any(isnan(radiance)) && !any(isinf(radiance));
        if (!valid) radiance = vec3(0.0);
        imageStore(source_image, ivec2(texel), vec4(radiance, 1.0));
        if (!DYNAMIC) {
            Patch p = patch_of(texel, Piece(g.x - 1u, g.y, 0u, 0u));
            float area = length(cross(p.du, p.dv));
            float luminance = dot(radiance, vec3(0.2126, 0.7152, 0.0722));
            mine = vec4(luminance * area, area, max(albedo.r, max(albedo.g, albedo.b)), valid ? 0.0 : 1.0);
        }
    }
    // Within frames nobody reads sums.
    if (DYNAMIC) return;
    uint lane = gl_LocalInvocationID.x;
    group[lane] = mine;
    barrier();
    // Pairwise, in an order of its own: the same bits on every run.
    for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
        if (lane < half_size) {
            vec4 other = group[lane + half_size];
            group[lane] = vec4(group[lane].xy + other.xy, max(group[lane].z, other.z), group[lane].w + other.w);
        }
        barrier();
    }
    if (lane == 0u && has_sum()) sums[work_group()] = group[0];
}

// What a ray sees: at its hit the source map, beyond the scene the sky.
#ifndef RADIANCE_GLSL
#define RADIANCE_GLSL

#include "scene.glsl"
#include "sky.glsl"

layout(set = 0, binding = 10) uniform texture2D source_map;
layout(set = 0, binding = 18, rgba32f) readonly uniform image2D emission_image;

// In a dynamic scene the source map holds what is reflected, and emission, which may change at any time, is added here.
vec3 emitted(uint primitive, ivec2 texel) {
    vec3 emission = materials[primitives[primitive].material].emission;
    return EMISSION_TEXTURES && emission != vec3(0.0) ? emission * imageLoad(emission_image, texel).rgb : emission;
}

// In texels of the light map.
vec2 place_of_hit(Hit hit) {
    vec2 t0 = corner_texel(hit.instance, hit.primitive, 0u);
    vec2 t1 = corner_texel(hit.instance, hit.primitive, 1u);
    vec2 t2 = corner_texel(hit.instance, hit.primitive, 2u);
    vec2 place = t0 + (t1 - t0) * hit.barycentrics.x + (t2 - t0) * hit.barycentrics.y;
    return clamp(place, vec2(0.0), vec2(push.map_size) - 0.001);
}

bool is_black_back(Hit hit) {
    return SINGLE_SIDED && !hit.front_face && (primitives[hit.primitive].flags & PRIMITIVE_DOUBLE_SIDED) == 0u;
}

bool is_mapped(Hit hit) {
    return !UNMAPPED || (primitives[hit.primitive].flags & PRIMITIVE_MAPPED) != 0u;
}

vec3 on_hit(Hit hit, ivec2 texel) {
    if (is_black_back(hit)) return vec3(0.0);
    if (!is_mapped(hit)) return materials[primitives[hit.primitive].material].emission;
    vec3 source = texelFetch(source_map, texel, 0).rgb;
    return DYNAMIC ? source + emitted(hit.primitive, texel) : source;
}

vec3 on_miss(vec3 direction) {
    return sky_radiance(direction);
}

#endif

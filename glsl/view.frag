#version 460
// The benchmark's camera pass: albedo * irradiance / pi + emission, and the sun's gloss where the shadow map lets it.
// The sun's diffuse light is in the light map already; to add it again would double it.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/stage.glsl"

layout(set = 0, binding = 3, std430) readonly buffer Surfaces { Surface surfaces[]; };
layout(set = 0, binding = 4, std430) readonly buffer Pictures { Picture pictures[]; };
// Linear colours as four half floats.
layout(set = 0, binding = 5, std430) readonly buffer Pixels { uvec2 pixels[]; };
layout(set = 0, binding = 6) uniform sampler2DShadow shadow_map;
layout(set = 1, binding = 0) uniform texture2D light_map;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_texel;
layout(location = 3) in vec2 in_albedo_uv;
layout(location = 4) in vec2 in_emission_uv;
layout(location = 5) flat in uint in_material;
layout(location = 6) flat in uint in_mapped;

layout(location = 0) out vec4 out_colour;

const float PI = 3.14159265;
// A dull varnish: reflectance at normal incidence and exponent of its Blinn-Phong lobe.
const float GLOSS_REFLECTANCE = 0.04;
const float GLOSS_EXPONENT = 24.0;

// Bilinear by hand: a device need not filter 32-bit floats.
vec3 irradiance(vec2 texel) {
    ivec2 last = textureSize(light_map, 0) - 1;
    vec2 place = texel - 0.5;
    ivec2 lo = ivec2(floor(place));
    vec2 share = place - vec2(lo);
    ivec2 a = clamp(lo, ivec2(0), last), b = clamp(lo + 1, ivec2(0), last);
    vec3 top = mix(texelFetch(light_map, a, 0).rgb, texelFetch(light_map, ivec2(b.x, a.y), 0).rgb, share.x);
    vec3 bottom = mix(texelFetch(light_map, ivec2(a.x, b.y), 0).rgb, texelFetch(light_map, b, 0).rgb, share.x);
    return mix(top, bottom, share.y);
}

uint wrapped(int pixel, uint size, uint wrap) {
    int count = int(size);
    if (wrap == WRAP_REPEAT) return uint(((pixel % count) + count) % count);
    if (wrap != WRAP_MIRRORED_REPEAT) return uint(clamp(pixel, 0, count - 1));
    int twice = 2 * count;
    int inside = ((pixel % twice) + twice) % twice;
    return uint(inside < count ? inside : twice - 1 - inside);
}

vec3 pixel(Picture picture, ivec2 at) {
    uint x = wrapped(at.x, picture.width, picture.wrap & 0xffu);
    uint y = wrapped(at.y, picture.height, picture.wrap >> 8u);
    uvec2 halves = pixels[picture.first_pixel + y * picture.width + x];
    return vec3(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y).x);
}

vec3 colour(uint index, vec2 uv) {
    if (index == NO_PICTURE) return vec3(1.0);
    Picture picture = pictures[index];
    vec2 place = uv * vec2(picture.width, picture.height) - 0.5;
    ivec2 lo = ivec2(floor(place));
    vec2 share = place - vec2(lo);
    vec3 top = mix(pixel(picture, lo), pixel(picture, lo + ivec2(1, 0)), share.x);
    vec3 bottom = mix(pixel(picture, lo + ivec2(0, 1)), pixel(picture, lo + 1), share.x);
    return mix(top, bottom, share.y);
}

// Share of the sun that arrives, over 2 x 2 texels of the shadow map.
float sunlit(vec3 position) {
    vec3 place = (frame.world_to_sun * vec4(position, 1.0)).xyz;
    vec2 uv = place.xy * 0.5 + 0.5;
    float sum = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 shift = (vec2(i & 1, i >> 1) - 0.5) * frame.shadow_texel;
        sum += texture(shadow_map, vec3(uv + shift, place.z));
    }
    return 0.25 * sum;
}

vec3 gloss(vec3 normal) {
    vec3 to_sun = -frame.sun_direction;
    float facing = dot(normal, to_sun);
    if (facing <= 0.0) return vec3(0.0);
    vec3 halfway = normalize(to_sun + normalize(frame.eye - in_position));
    float lobe = (GLOSS_EXPONENT + 8.0) / (8.0 * PI) * pow(max(dot(normal, halfway), 0.0), GLOSS_EXPONENT);
    return GLOSS_REFLECTANCE * lobe * facing * sunlit(in_position) * frame.sun_irradiance;
}

vec3 srgb(vec3 linear) {
    vec3 low = 12.92 * linear;
    vec3 high = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(linear, vec3(0.0031308))));
}

void main() {
    Surface surface = surfaces[in_material];
    vec3 normal = normalize(gl_FrontFacing ? in_normal : -in_normal);
    vec3 light = in_mapped == 0u ? vec3(0.0) : irradiance(in_texel);
    vec3 radiance = surface.albedo * colour(surface.albedo_picture, in_albedo_uv) * light / PI;
    radiance += surface.emission * colour(surface.emission_picture, in_emission_uv);
    radiance += gloss(normal);
    // Never quite white, so that bright surfaces keep their colour's differences.
    out_colour = vec4(srgb(1.0 - exp(-max(radiance, vec3(0.0)) * frame.exposure)), 1.0);
}

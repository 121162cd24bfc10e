// A texel's irradiance: gathered by rays and from analytic lights, which are kept apart until here.
#ifndef IRRADIANCE_GLSL
#define IRRADIANCE_GLSL

// In a dynamic scene: the running average, and what the last visit alone gathered.
layout(set = 0, binding = 11, rgba32f) readonly uniform image2D mean_even;
layout(set = 0, binding = 12, rgba32f) readonly uniform image2D mean_odd;
layout(set = 0, binding = 16, rgba32f) readonly uniform image2D direct_image;

vec3 with_direct(ivec2 texel, vec3 gathered) {
    return LIGHTS ? gathered + imageLoad(direct_image, texel).rgb : gathered;
}

// Irradiance that the surface reflects. In a dynamic scene it is not filtered: bounces through the running average would
// take its latency each.
vec3 reflected_irradiance(ivec2 texel) {
    if (!GATHERING) return with_direct(texel, vec3(0.0));
    vec4 even = DYNAMIC ? vec4(0.0) : imageLoad(mean_even, texel);
    if (!DYNAMIC && !HALVES) return with_direct(texel, even.w > 0.0 ? even.rgb : vec3(0.0));
    vec4 odd = imageLoad(mean_odd, texel);
    if (DYNAMIC) return with_direct(texel, odd.rgb);
    bool any = even.w + odd.w > 0.0;
    return with_direct(texel, any ? even.rgb + (odd.rgb - even.rgb) * (odd.w / (even.w + odd.w)) : vec3(0.0));
}

// Irradiance that the light map shows.
vec3 shown_irradiance(ivec2 texel) {
    return DYNAMIC ? with_direct(texel, imageLoad(mean_even, texel).rgb) : reflected_irradiance(texel);
}

#endif

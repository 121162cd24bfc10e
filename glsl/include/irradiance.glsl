// A texel's irradiance: gathered by rays and from analytic lights, which are kept apart until here.
#ifndef IRRADIANCE_GLSL
#define IRRADIANCE_GLSL

layout(set = 0, binding = 11, rgba32f) readonly uniform image2D mean_even;
layout(set = 0, binding = 12, rgba32f) readonly uniform image2D mean_odd;
layout(set = 0, binding = 16, rgba32f) readonly uniform image2D direct_image;

vec3 irradiance_of(ivec2 texel) {
    vec4 even = imageLoad(mean_even, texel);
    vec4 odd = imageLoad(mean_odd, texel);
    vec3 gathered = even.w + odd.w > 0.0 ? even.rgb + (odd.rgb - even.rgb) * (odd.w / (even.w + odd.w)) : vec3(0.0);
    return LIGHTS ? gathered + imageLoad(direct_image, texel).rgb : gathered;
}

#endif

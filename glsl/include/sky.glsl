// What a ray sees that leaves the scene.
#ifndef SKY_GLSL
#define SKY_GLSL

layout(set = 0, binding = 7) uniform sampler2D sky_map;

vec3 sky_radiance(vec3 direction) {
    if (SKY_CONSTANT) return push.sky;
    if (!SKY_MAP) return vec3(0.0);
    vec2 uv = vec2(atan(direction.z, direction.x) / (2.0 * PI) + 0.5, acos(clamp(direction.y, -1.0, 1.0)) / PI);
    ivec2 size = textureSize(sky_map, 0);
    return texelFetch(sky_map, min(ivec2(uv * vec2(size)), size - 1), 0).rgb;
}

#endif

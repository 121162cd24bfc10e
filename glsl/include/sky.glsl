// What a ray sees that leaves the scene.
#ifndef SKY_GLSL
#define SKY_GLSL

layout(set = 0, binding = 7) uniform sampler2D sky_map;

ivec2 sky_pixel(vec3 direction) {
    vec2 uv = vec2(atan(direction.z, direction.x) / (2.0 * PI) + 0.5, acos(clamp(direction.y, -1.0, 1.0)) / PI);
    ivec2 size = textureSize(sky_map, 0);
    return min(ivec2(uv * vec2(size)), size - 1);
}

// Of a pixel in this row; as a product, for the cosines of a pole's row differ by little.
float sky_solid_angle(uint row, uvec2 size) {
    float rows = PI / float(size.y);
    return 2.0 * PI / float(size.x) * 2.0 * sin((float(row) + 0.5) * rows) * sin(0.5 * rows);
}

vec3 sky_radiance(vec3 direction) {
    if (SKY_CONSTANT) return push.sky;
    return SKY_MAP ? texelFetch(sky_map, sky_pixel(direction), 0).rgb : vec3(0.0);
}

#endif

#version 460
// Irradiance from analytic lights. The light is taken at the texel's centre, what part of the texel sees it from shadow
// rays over the footprint: a few, and more where they disagree.
#extension GL_GOOGLE_include_directive : require
#include "include/rays.glsl"
#include "include/texels.glsl"
#include "include/lights.glsl"

layout(set = 0, binding = 9, r32ui) readonly uniform uimage2D footprint_image;
layout(set = 0, binding = 16, rgba32f) writeonly uniform image2D direct_image;

// Whether a point of the footprint sees the light.
bool sees(Surface s, vec4 sides, vec2 at, Light light) {
    vec3 point = point_at(s, on_triangle(s, at) ? at : clamp(s.start, sides.xy, sides.zw));
    // The direction and distance of this very point, from the offset origin, so that a near light is not overshot.
    Ray ray = ray_from(s, point, vec3(0.0), 1e30);
    Incident incident = incident_of(light, ray.origin, s.normal);
    ray.direction = incident.direction;
    ray.t_max = incident.distance;
    return dot(ray.direction, s.geometric_normal) > 0.0 && !trace_occluded(ray);
}

// Share of a `side` x `side` grid over the footprint that sees the light.
float visible_share(Surface s, vec4 sides, Light light, uint side) {
    uint count = 0u;
    for (uint i = 0u; i < side * side; ++i) {
        vec2 u = (vec2(i % side, i / side) + 0.5) / float(side);
        count += uint(sees(s, sides, mix(sides.xy, sides.zw, u), light));
    }
    return float(count) / float(side * side);
}

void main() {
    uvec2 texel;
    if (!texel_of_invocation(texel)) return;
    uvec4 g = imageLoad(surface_image, ivec2(texel));
    if (DYNAMIC && (instances[g.x - 1u].flags & INSTANCE_ABSENT) != 0u) return;
    Surface s = surface_of(texel, g);
    vec4 sides = unpack_footprint(imageLoad(footprint_image, ivec2(texel)).x);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < push.light_count; ++i) {
        Light light = lights[i];
        vec3 irradiance = incident_of(light, point_at(s, s.centre), s.normal).irradiance;
        if (irradiance == vec3(0.0)) continue;
        float share = visible_share(s, sides, light, 2u);
        if (share > 0.0 && share < 1.0) share = visible_share(s, sides, light, 6u);
        sum += irradiance * share;
    }
    imageStore(direct_image, ivec2(texel), vec4(sum, 1.0));
}

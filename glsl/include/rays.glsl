// Rays that start on a texel's surface.
#ifndef RAYS_GLSL
#define RAYS_GLSL

#include "ray_query.glsl"
#include "surface.glsl"

Ray ray_from(Surface s, vec3 point, vec3 direction, float t_max) {
    return Ray(point + s.geometric_normal * push.origin_offset, 0.0, direction, t_max, s.instance, s.primitive);
}

#endif

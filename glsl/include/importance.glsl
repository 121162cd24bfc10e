// Rays toward light: to texels by luminance times area, and to a sky map's pixels by luminance times solid angle, each
// with its density over solid angle. Both that a ray was aimed at something and that a cosine-distributed one happened to
// go there are weighed by the densities of all techniques.
//
// "Interactive Light Mapping with PowerVR Ray Tracing": sample the light map by its luminance, with a line-of-sight ray.
#ifndef IMPORTANCE_GLSL
#define IMPORTANCE_GLSL

#include "clusters.glsl"
#include "pieces.glsl"
#include "pyramid.glsl"
#include "sky.glsl"

layout(set = 0, binding = 26) uniform texture2D importance_map;
layout(set = 0, binding = 27) uniform texture2D sky_importance_map;
// Leaves, over their areas: aimed_luminance in pieces.glsl.
layout(set = 0, binding = 33, r32f) readonly uniform image2D aimed_luminance_image;

// Finite, for 0 times it must be 0.
const float MOST_DENSITY = 1e30;
// A line of sight goes a little beyond its end, which rounding must not hide.
const float BEYOND_SIGHT = 1.001;

// What a line of sight must find.
struct Target {
    uint cluster;
    uvec2 texel;
    Piece piece;
};

bool is_target(Hit hit, vec2 place, Target target) {
    return uvec2(place) == target.texel && hit.instance == target.piece.instance
           && primitives[hit.primitive].sheet == primitives[target.piece.primitive].sheet;
}

// One of a texel's pieces, by area: a later one takes the place of those before in proportion to its share of all so far.
Patch choose_patch(uvec2 texel, float u, out Piece chosen_piece) {
    Shared s = pieces_of(texel, imageLoad(surface_image, ivec2(texel)));
    Patch chosen;
    float total = 0.0;
    for (uint i = 0u; i < s.count; ++i) {
        Piece piece = piece_at(s, i);
        Patch p = patch_of(texel, piece);
        float area = is_present(piece) ? length(area_of(p)) : 0.0;
        total += area;
        float share = i == 0u ? 1.0 : area / total;
        if (u < share) {
            chosen = p;
            chosen_piece = piece;
            u /= share;
        } else {
            u = (u - share) / (1.0 - share);
        }
    }
    return chosen;
}

// Cosine at what a ray hit, where rays are aimed at that; else 0.
float cosine_at_piece(Hit hit, vec2 place, vec3 direction) {
    uvec2 texel = uvec2(place);
    Shared s = pieces_of(texel, imageLoad(surface_image, ivec2(texel)));
    for (uint i = 0u; i < s.count; ++i) {
        Piece piece = piece_at(s, i);
        // Triangles of a sheet are one plane in the texel.
        if (piece.instance != hit.instance || primitives[piece.primitive].sheet != primitives[hit.primitive].sheet) continue;
        Patch p = patch_of(texel, piece);
        vec2 at = place - vec2(texel);
        // Not by the rounding of where the hit is in the light map.
        float slack = 2.4e-7 * max(place.x, place.y);
        if (any(lessThan(at, p.lo - slack)) || any(greaterThan(at, p.hi + slack))) return 0.0;
        vec3 area = cross(p.du, p.dv);
        return abs(dot(area, direction)) / length(area);
    }
    return 0.0;
}

// The texel that `choice` in [0,1) chooses; false: there is none. `row`: of the starting texel's group.
bool choose_source(uint row, float choice, float fresh, uint texel, uint sample_index, inout Target target) {
    if (!CLUSTERS) return choose_leaf(importance_map, push.map_size, choice, texel, sample_index, target.texel);
    if (!choose_cluster(row, fresh, choice, target.cluster)) return false;
    target.texel = choose_texel(target.cluster, choice);
    return true;
}

// From the ray's origin to a point of a texel that `u` chooses.
bool aim_at_texel(vec3 u, inout Ray ray, inout Target target) {
    Patch p = choose_patch(target.texel, u.z, target.piece);
    vec2 at = mix(p.lo, p.hi, u.xy);
    vec3 way = p.origin + p.du * at.x + p.dv * at.y - ray.origin;
    float far = length(way);
    if (!(far > 0.0)) return false;
    ray.direction = way / far;
    ray.t_max = far * BEYOND_SIGHT;
    return true;
}

// Density over solid angle of a ray that the source technique aims to where this one hit. `total`: of the pyramid.
float source_density(Hit hit, vec2 place, vec3 direction, uint row, float total) {
    uvec2 texel = uvec2(place);
    float luminance = imageLoad(aimed_luminance_image, ivec2(texel)).x;
    float cosine = luminance > 0.0 ? cosine_at_piece(hit, place, direction) : 0.0;
    if (!(cosine > 0.0)) return 0.0;
    if (DYNAMIC) {
        // What has been scaled or has gone since the leaves were made is chosen as often as before, over its new area.
        luminance /= area_of_pieces(texel, pieces_of(texel, imageLoad(surface_image, ivec2(texel))));
    }
    if (CLUSTERS) {
        uint cluster = cluster_of(texel);
        luminance *= share_of(row, cluster);
        total = max(clusters[cluster].power, 1e-37);
    }
    return min(luminance / total * hit.t / cosine * hit.t, MOST_DENSITY);
}

// Toward a pixel of the sky that `choice` chooses, evenly over its solid angle.
bool aim_at_sky(float choice, vec2 u, uint texel, uint sample_index, inout Ray ray) {
    uvec2 size = uvec2(textureSize(sky_map, 0));
    uvec2 pixel;
    if (!choose_leaf(sky_importance_map, size, choice, texel, sample_index, pixel)) return false;
    int row = int(pixel.y), rows = int(size.y);
    float y = mix(sky_row_cosine(row, rows), sky_row_cosine(row + 1, rows), u.y);
    float angle = sky_column_angle(float(pixel.x) + u.x, int(size.x));
    float radius = sqrt(max(0.0, 1.0 - y * y));
    ray.direction = vec3(radius * cos(angle), y, radius * sin(angle));
    ray.t_max = 1e30;
    return true;
}

float sky_density(vec3 direction, float total) {
    uvec2 size = uvec2(textureSize(sky_map, 0));
    uvec2 pixel = uvec2(sky_pixel(direction));
    return pyramid_leaf(sky_importance_map, pixel) / total / sky_solid_angle(pixel.y, size);
}

#endif

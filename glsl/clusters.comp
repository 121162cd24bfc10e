#version 460
// Clusters of source texels: one work group sums up the leaves of each, in order, and tells where they are and which way
// they face. A leaf becomes what it adds to the sum, so that each is chosen just as often as its density says.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/pieces.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 33, r32f) uniform image2D aimed_luminance_image;
layout(set = 0, binding = 34, std430) buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 35, std430) readonly buffer ClusterTexels { uint cluster_texels[]; };
layout(set = 0, binding = 36, std430) writeonly buffer ClusterSums { float cluster_sums[]; };

// Less has no inverse.
const float LEAST_POWER = 1e-37;

shared float sums[65];    // of leaves; the first is what comes before
shared float total;
shared vec4 moments[64];  // of places: sums weighed by the leaves, and of the squared distances
shared vec4 facings[64];  // of normals; w: leaves that shine from both sides

vec3 centre_of(Patch p) {
    vec2 middle = 0.5 * (p.lo + p.hi);
    return p.origin + p.du * middle.x + p.dv * middle.y;
}

vec3 front_of(Piece piece) {
    vec3 v0 = triangles[piece.primitive].corners[0].xyz;
    vec3 n = cross(triangles[piece.primitive].corners[1].xyz - v0, triangles[piece.primitive].corners[2].xyz - v0);
    return to_world_normal(piece.instance, normalize(n / max(abs(n.x), max(abs(n.y), abs(n.z)))));
}

// In units of the scene's reach, so that no product is beyond 32-bit floats.
void add(vec3 middle, Patch p, float reach, vec3 front, bool two_sided, float leaf) {
    uint lane = gl_LocalInvocationIndex;
    vec3 way = (centre_of(p) - middle) / reach;
    vec2 sides = (p.hi - p.lo) / reach;
    vec3 du = p.du * sides.x, dv = p.dv * sides.y;
    float within = (dot(du, du) + dot(dv, dv)) / 12.0;
    vec4 moment = vec4(way, dot(way, way) + within);
    // A sliver whose plane is no number has no place.
    if (any(isnan(moment)) || any(isinf(moment))) moment = vec4(0.0);
    moments[lane] += leaf * moment;
    facings[lane] += leaf * vec4(two_sided ? vec3(0.0) : front, two_sided ? 1.0 : 0.0);
}

void main() {
    uint lane = gl_LocalInvocationIndex;
    uint index = push.first_level + gl_WorkGroupID.x;
    if (push.map_size.x == 0u || index >= clusters.length()) return;
    uint first = clusters[index].first, count = clusters[index].count;
    moments[lane] = facings[lane] = vec4(0.0);
    uvec2 texel = uvec2(cluster_texels[first] & 0xffffu, cluster_texels[first] >> 16u);
    uvec4 g = imageLoad(surface_image, ivec2(texel));
    vec3 middle = centre_of(patch_of(texel, Piece(g.x - 1u, g.y, 0u, 0u)));
    // The origin offset is 2^-17 of it.
    float reach = max(push.origin_offset * 131072.0, 1e-30);
    if (lane == 0u) total = 0.0;
    for (uint begin = 0u; begin < count; begin += 64u) {
        uint place = first + begin + lane;
        bool has_texel = begin + lane < count;
        float area = 0.0;
        float leaf = 0.0;
        if (has_texel) {
            texel = uvec2(cluster_texels[place] & 0xffffu, cluster_texels[place] >> 16u);
            g = imageLoad(surface_image, ivec2(texel));
            Shared s = pieces_of(texel, g);
            area = area_of_pieces(texel, s);
            leaf = imageLoad(aimed_luminance_image, ivec2(texel)).x * (DYNAMIC ? 1.0 : area);
            for (uint i = 0u; i < s.count && leaf > 0.0; ++i) {
                Piece piece = piece_at(s, i);
                if (!is_present(piece)) continue;
                Patch p = patch_of(texel, piece);
                float part = length(area_of(p)) / area;
                bool two_sided = !SINGLE_SIDED || (primitives[piece.primitive].flags & PRIMITIVE_DOUBLE_SIDED) != 0u;
                add(middle, p, reach, front_of(piece), two_sided, part * leaf);
            }
        }
        sums[lane + 1u] = leaf;
        barrier();
        // In order, for sums must not fall.
        if (lane == 0u) {
            sums[0] = total;
            for (uint i = 1u; i <= 64u; ++i) sums[i] = total += sums[i];
        }
        barrier();
        float below = sums[lane], sum = sums[lane + 1u];
        if (has_texel) {
            cluster_sums[place] = sum;
            imageStore(aimed_luminance_image, ivec2(texel), vec4(aimed_luminance(sum - below, area)));
        }
        barrier();
    }
    for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
        if (lane < half_size) {
            moments[lane] += moments[lane + half_size];
            facings[lane] += facings[lane + half_size];
        }
        barrier();
    }
    if (lane != 0u) return;
    vec4 moment = moments[0], facing = facings[0];
    float inverse = total > LEAST_POWER ? 1.0 / total : 0.0;
    vec3 way = moment.xyz * inverse;
    vec3 axis = facing.xyz * inverse;
    float two_sided = facing.w * inverse;
    clusters[index].centre = middle + way * reach;
    clusters[index].spread = sqrt(max(moment.w * inverse - dot(way, way), 0.0)) * reach;
    clusters[index].axis = axis;
    // Normals that do not agree leave a shorter axis.
    clusters[index].even = two_sided + 0.5 * max(1.0 - two_sided - length(axis), 0.0);
    clusters[index].power = total > LEAST_POWER ? total : 0.0;
}

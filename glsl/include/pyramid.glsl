// A mip map as a cumulative distribution: a pyramid of 2 x 2 sums over leaves, walked from its top to choose one.
//
// Its levels lie in one image: level 0 at the left, the others below each other at its right. A texel of a level holds
// its four children, (0,0), (1,0), (0,1), (1,1); those of level 0 are the leaves. Sides are powers of two; what lies
// beyond the leaves is 0. The host's twin is src/pass/importance.rs.
#ifndef PYRAMID_GLSL
#define PYRAMID_GLSL

// Random numbers of a walk begin at this dimension.
const uint WALK_DIMENSION = 16u;

uvec2 power_of_two(uvec2 n) {
    return uvec2(1u) << uvec2(findMSB(n - 1u) + 1);
}

// Size of level 0.
uvec2 base_of(uvec2 leaves) {
    return power_of_two((max(leaves, uvec2(1u)) + 1u) / 2u);
}

uint levels_of(uvec2 base) {
    return uint(findMSB(max(base.x, base.y))) + 1u;
}

uvec2 level_size(uvec2 base, uint level) {
    return max(base >> level, uvec2(1u));
}

uvec2 level_origin(uvec2 base, uint level) {
    if (level == 0u) return uvec2(0u);
    // Heights of levels 1 to level - 1, which do not fall below 1.
    uint above = level - 1u;
    uint halvings = uint(findMSB(base.y));
    uint rows = above <= halvings ? base.y - (base.y >> above) : base.y - 1u + above - halvings;
    return uvec2(base.x, rows);
}

float sum_of(vec4 children) {
    return (children.x + children.y) + (children.z + children.w);
}

float pyramid_total(texture2D pyramid, uvec2 leaves) {
    uvec2 base = base_of(leaves);
    return sum_of(texelFetch(pyramid, ivec2(level_origin(base, levels_of(base) - 1u)), 0));
}

float pyramid_leaf(texture2D pyramid, uvec2 leaf) {
    vec4 siblings = texelFetch(pyramid, ivec2(leaf / 2u), 0);
    return siblings[(leaf.x & 1u) | (leaf.y & 1u) << 1u];
}

void put_in_order(inout float a, inout float b, inout uint a_child, inout uint b_child) {
    if (a <= b) return;
    float larger = a;
    uint larger_child = a_child;
    a = b;
    b = larger;
    a_child = b_child;
    b_child = larger_child;
}

// Children by their value, the least first: floats are dense near 0, and a child of 2^-24 of the whole has its share there
// and not near 1, where steps are as large.
void sort(inout vec4 values, out uvec4 children) {
    children = uvec4(0u, 1u, 2u, 3u);
    put_in_order(values.x, values.y, children.x, children.y);
    put_in_order(values.z, values.w, children.z, children.w);
    put_in_order(values.x, values.z, children.x, children.z);
    put_in_order(values.y, values.w, children.y, children.w);
    put_in_order(values.y, values.z, children.y, children.z);
}

// Chooses a leaf with a probability in proportion to its value; false: all are 0. `u` in [0,1) decides at every level: what
// is left of it at the next one has lost bits, which are made up for by fresh ones.
bool choose_leaf(texture2D pyramid, uvec2 leaves, float u, uint texel, uint sample_index, out uvec2 leaf) {
    uvec2 base = base_of(leaves);
    uint levels = levels_of(base);
    vec4 fresh = vec4(0.0);
    leaf = uvec2(0u);
    for (uint down = 0u; down < levels; ++down) {
        if (down % 4u == 0u) fresh = random4(texel, sample_index, WALK_DIMENSION + down / 4u);
        vec4 values = texelFetch(pyramid, ivec2(level_origin(base, levels - 1u - down) + leaf), 0);
        uvec4 children;
        sort(values, children);
        vec4 starts = vec4(0.0, values.x, values.x + values.y, values.x + values.y + values.z);
        float sum = starts.w + values.w;
        if (!(sum > 0.0)) return false;
        // Children that are 0 come first and have no part.
        float x = u * sum;
        uint place = uint(x >= starts.y) + uint(x >= starts.z) + uint(x >= starts.w);
        float inverse = 1.0 / values[place];
        u = (x - starts[place]) * inverse + fresh[down % 4u] * (sum * inverse / 16777216.0);
        u = clamp(u, 0.0, 0.99999994);
        leaf = leaf * 2u + uvec2(children[place] & 1u, children[place] >> 1u);
    }
    return true;
}

#endif

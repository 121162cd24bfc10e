// What lies in a texel: the g-buffer's primitive, and in a few texels others beside it (src/pass/pieces.rs).
#ifndef PIECES_GLSL
#define PIECES_GLSL

#include "surface.glsl"

layout(set = 0, binding = 31, r32ui) readonly uniform uimage2D pieces_image;
layout(set = 0, binding = 32, std430) readonly buffer Pieces { Piece pieces[]; };

// Of a texel: the g-buffer's alone, or those of the list.
struct Shared {
    Piece owner;
    bool listed;
    uint first;
    uint count;
};

// `g`: the g-buffer's; the texel has a surface.
Shared pieces_of(uvec2 texel, uvec4 g) {
    uint code = SHARED_TEXELS ? imageLoad(pieces_image, ivec2(texel)).x : 0u;
    return Shared(Piece(g.x - 1u, g.y, 0u, 0u), code != 0u, code & 0xffffffu, max(code >> 24u, 1u));
}

Piece piece_at(Shared s, uint index) {
    if (!SHARED_TEXELS || !s.listed) return s.owner;
    return pieces[s.first + index];
}

bool is_present(Piece piece) {
    return !DYNAMIC || (instances[piece.instance].flags & INSTANCE_ABSENT) == 0u;
}

// A leaf as the image of aimed luminances has it: over its area, but in a dynamic scene, where areas change, as it is.
float aimed_luminance(float leaf, float area) {
    if (DYNAMIC) return leaf;
    return area > 0.0 ? leaf / area : 0.0;
}

// World area of all pieces.
float area_of_pieces(uvec2 texel, Shared s) {
    float area = 0.0;
    for (uint i = 0u; i < s.count; ++i) {
        Piece piece = piece_at(s, i);
        if (is_present(piece)) area += length(area_of(patch_of(texel, piece)));
    }
    return area;
}

#endif

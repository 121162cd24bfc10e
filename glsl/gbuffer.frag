#version 460
// Light-map-space g-buffer: a texel that a triangle touches gets the triangle's point nearest to its centre. The depth
// test keeps the nearest triangle, so that one which holds the centre wins over one which only touches.
// All in object space: a moved object is not drawn again.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/gbuffer.glsl"

layout(location = 0) out uvec4 out_surface;

void main() {
    Drawn drawn = draw();
    gl_FragDepth = drawn.depth;
    out_surface = surface_of(drawn);
}

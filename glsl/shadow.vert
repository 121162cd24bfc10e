#version 460
// The benchmark's shadow map: depth as seen from the sun.
#extension GL_GOOGLE_include_directive : require
#include "include/stage.glsl"

void main() {
    gl_Position = frame.world_to_sun * vec4(world_position(gl_VertexIndex, gl_InstanceIndex), 1.0);
}

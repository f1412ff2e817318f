#version 330 core
// A square that faces the viewer, of the same size on screen at any distance.
uniform vec2 centre; // normalised device units
uniform vec2 halfSize;

out vec2 corner; // -1 to 1 across the square

void main() {
    corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    gl_Position = vec4(centre + corner * halfSize, 0.0, 1.0);
}

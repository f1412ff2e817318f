#version 330 core
// How far in front of the viewer each second pixel is, in radii; where nothing is, very far.
uniform sampler2D depths;
uniform vec2 pixels;
uniform vec2 depthRow;     // of the projection: the factor of z, and what is added
uniform float perspective; // 1 perspective, 0 orthographic
uniform float radius;

out float distance;

void main() {
    ivec2 pixel = min(2 * ivec2(gl_FragCoord.xy), ivec2(pixels) - 1);
    float depth = texelFetch(depths, pixel, 0).r;
    float clip = 2.0 * depth - 1.0;
    float ahead = perspective > 0.5 ? depthRow.y / (clip + depthRow.x) : (depthRow.y - clip) / depthRow.x;
    distance = depth < 1.0 ? ahead / radius : 1e6;
}

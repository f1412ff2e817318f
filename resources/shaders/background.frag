#version 330 core
in float height;

uniform vec3 bottomColour;
uniform vec3 topColour;

out vec4 colour;

void main() {
    // Half a grey level of noise, so that the slow gradient shows no bands.
    float noise = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) - 0.5;
    colour = vec4(mix(bottomColour, topColour, smoothstep(0.0, 1.0, height)) + noise / 255.0, 1.0);
}

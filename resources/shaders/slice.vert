#version 330 core
layout(location = 0) in vec3 position; // grid index units
layout(location = 1) in vec2 place;    // in the texture

uniform mat4 modelToView;
uniform mat4 viewToClip;

out vec2 texturePlace;

void main() {
    texturePlace = place;
    gl_Position = viewToClip * (modelToView * vec4(position, 1.0));
}

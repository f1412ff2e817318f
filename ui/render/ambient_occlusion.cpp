#include "ui/render/ambient_occlusion.h"

#include <QVector2D>

#include <glm/common.hpp>

namespace isoslider::render {
namespace {

QVector2D toQt(const glm::dvec2& v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }

void setSize(QOpenGLShaderProgram& program, const char* name, glm::ivec2 size) {
    program.setUniformValue(name, QVector2D(static_cast<float>(size.x), static_cast<float>(size.y)));
}

} // namespace

AmbientOcclusion::~AmbientOcclusion() {
    if (emptyArray_ == 0)
        return;
    for (Target* target : {&distances_, &open_, &smoothed_})
        free(*target);
    gl_.glDeleteVertexArrays(1, &emptyArray_);
}

void AmbientOcclusion::abandon() {
    emptyArray_ = 0;
    depths_.abandon();
    for (auto* program : {&distance_, &occlusion_, &smoothing_, &darkening_})
        program->reset();
}

void AmbientOcclusion::free(Target& target) {
    gl_.glDeleteFramebuffers(1, &target.framebuffer);
    gl_.glDeleteTextures(1, &target.texture);
    target = {};
}

bool AmbientOcclusion::allocate(Target& target, GLenum format) {
    free(target);
    gl_.glGenFramebuffers(1, &target.framebuffer);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    gl_.glGenTextures(1, &target.texture);
    gl_.glBindTexture(GL_TEXTURE_2D, target.texture);
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), room_.x, room_.y, 0, GL_RED, GL_FLOAT, nullptr);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl_.glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.texture, 0);
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    return gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool AmbientOcclusion::prepare(glm::ivec2 half) {
    if (emptyArray_ == 0) {
        gl_.glGenVertexArrays(1, &emptyArray_);
        distance_ = loadProgram("background", "occlusion_distance");
        occlusion_ = loadProgram("background", "occlusion");
        smoothing_ = loadProgram("background", "occlusion_smoothing");
        darkening_ = loadProgram("background", "occlusion_darkening");
    }
    if (distance_ == nullptr || occlusion_ == nullptr || smoothing_ == nullptr || darkening_ == nullptr)
        return false;
    if (glm::max(room_, half) != room_) {
        room_ = glm::max(room_, half);
        isBroken_ = !allocate(distances_, GL_R32F) || !allocate(open_, GL_R8) || !allocate(smoothed_, GL_R8);
    }
    return !isBroken_;
}

// Runs a program for each pixel of a target, or of the picture, over the viewport that is set.
void AmbientOcclusion::fill(const Target* target, QOpenGLShaderProgram& program, std::array<GLuint, 3> textures) {
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target == nullptr ? picture_ : target->framebuffer);
    for (std::size_t unit = 0; unit < textures.size(); ++unit) {
        gl_.glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
        gl_.glBindTexture(GL_TEXTURE_2D, textures[unit]);
    }
    gl_.glDrawArrays(GL_TRIANGLES, 0, 3);
    program.release();
}

void AmbientOcclusion::takePictures(glm::ivec2 pixels, glm::ivec2 half, const glm::dmat4& viewToClip, double radius) {
    const bool isPerspective = viewToClip[3][3] == 0.0;
    const auto bind = [&](QOpenGLShaderProgram& program) {
        program.bind();
        program.setUniformValue("depths", 0);
        program.setUniformValue("distances", 1);
        program.setUniformValue("openness", 2);
        setSize(program, "pixels", pixels);
        setSize(program, "halfPixels", half);
        program.setUniformValue("depthRow", toQt({viewToClip[2][2], viewToClip[3][2]}));
        // Half the view, in radii: at distance 1 in perspective.
        program.setUniformValue("halfView", toQt(glm::dvec2(1.0 / viewToClip[0][0], 1.0 / viewToClip[1][1]) /
                                                 (isPerspective ? 1.0 : radius)));
        program.setUniformValue("perspective", isPerspective ? 1.0f : 0.0f);
        program.setUniformValue("radius", static_cast<float>(radius));
    };
    gl_.glViewport(0, 0, half.x, half.y);
    bind(*distance_);
    fill(&distances_, *distance_, {depths_.texture(), 0, 0});
    bind(*occlusion_);
    fill(&open_, *occlusion_, {0, distances_.texture, 0});
    for (const bool isUpright : {false, true}) {
        bind(*smoothing_);
        smoothing_->setUniformValue("along", isUpright ? QVector2D(0.0f, 1.0f) : QVector2D(1.0f, 0.0f));
        fill(isUpright ? &open_ : &smoothed_, *smoothing_,
             {0, distances_.texture, isUpright ? smoothed_.texture : open_.texture});
    }
    gl_.glViewport(0, 0, pixels.x, pixels.y);
    gl_.glEnable(GL_BLEND);
    gl_.glBlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_ZERO, GL_ONE);
    bind(*darkening_);
    fill(nullptr, *darkening_, {depths_.texture(), distances_.texture, open_.texture});
    gl_.glDisable(GL_BLEND);
}

void AmbientOcclusion::draw(glm::ivec2 pixels, const model::Camera& camera) {
    GLint bound = 0;
    gl_.glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    picture_ = static_cast<GLuint>(bound);
    const glm::ivec2 half = (pixels + 1) / 2;
    if (prepare(half) && depths_.copy(picture_, pixels)) {
        gl_.glDisable(GL_DEPTH_TEST);
        gl_.glDisable(GL_BLEND);
        gl_.glBindVertexArray(emptyArray_);
        takePictures(pixels, half, camera.projectionMatrix(static_cast<double>(pixels.x) / pixels.y),
                     kReach * camera.halfHeight());
        gl_.glBindVertexArray(0);
        for (const GLenum unit : {GL_TEXTURE2, GL_TEXTURE1, GL_TEXTURE0}) {
            gl_.glActiveTexture(unit);
            gl_.glBindTexture(GL_TEXTURE_2D, 0);
        }
        gl_.glEnable(GL_DEPTH_TEST);
    }
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, picture_);
}

} // namespace isoslider::render

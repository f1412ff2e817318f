// Several surfaces: each hides its own pieces.
#include "tests/gui/pieces_fixture.h"

namespace isoslider::test {
namespace {

// Two surfaces, each with a piece that is hidden.
class SurfacesWithPiecesTest : public PickTest {
protected:
    static void letStepEnd() { QTest::qWait(600); }
    model::SurfacesModel& surfaces() { return session_->surfaces(); }
    const model::HiddenPieces& hiddenOf(std::size_t place) { return surfaces().list().surfaces[place].hiddenPieces; }
    void hide(int cone) {
        pick(pixelOf(cone));
        ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
        QTest::keyClick(window_.get(), Qt::Key_H);
        letStepEnd();
    }
    void addAt(double isovalue) {
        QTest::keyClick(window_.get(), Qt::Key_Insert);
        slideTo(isovalue);
        ASSERT_TRUE(waitUntilSettled());
        letStepEnd();
    }
    void activateNext() {
        QTest::keyClick(window_.get(), Qt::Key_N);
        const double isovalue = session_->isovalue().requested();
        ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == isovalue; }));
        ASSERT_TRUE(waitUntilSettled());
        letStepEnd();
    }
    void showOnly(std::size_t place) {
        for (std::size_t k = 0; k < surfaces().list().surfaces.size(); ++k)
            surfaces().change(surfaces().list().surfaces[k].id, [&](model::ListedSurface& surface) {
                surface.isVisible = k == place;
                surface.opacity = 1.0;
            });
        ASSERT_TRUE(waitUntilSettled());
    }
    /// Which of the cones are seen.
    std::vector<bool> seen() {
        const QImage picture = window_->viewportHost().picture();
        const QRgb background = picture.pixel(pixelOf(0).x(), 12);
        std::vector<bool> seen;
        for (const int cone : {0, 1, 2})
            seen.push_back(qGray(picture.pixel(pixelOf(cone))) > qGray(background) + 40);
        return seen;
    }
    using Seen = std::vector<bool>;
};

TEST_F(SurfacesWithPiecesTest, AnotherOneHidesAndShowsNothingOfTheFirst) {
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    hide(1);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    addAt(1.0);
    EXPECT_FALSE(pieces().hidesAny()) << "the new one is whole";
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    letStepEnd();
    hide(0);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    activateNext();
    EXPECT_EQ(seen(), (Seen{true, false, true})) << "it keeps its numbers while another one slides";
    ASSERT_EQ(pieces().hidden.size(), 1u);
    EXPECT_EQ(pieces().hidden.front(), piece(1).id);
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
    keepPicture(*window_, "pieces_of_two_surfaces");
}

TEST_F(SurfacesWithPiecesTest, ADoubleClickOnAnotherSurfaceMakesItActiveAndSelectsItsPiece) {
    addAt(1.0); // larger cones around the first ones
    for (const model::ListedSurface& surface : surfaces().list().surfaces)
        surfaces().change(surface.id, [](model::ListedSurface& changed) { changed.opacity = 1.0; });
    activateNext();
    ASSERT_EQ(session_->frame()->isovalue, 1.5);
    letStepEnd();
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.0 && pieces().selected.has_value(); }))
        << "the outer one is in front";
    EXPECT_EQ(*pieces().selected, piece(1).id);
    surfaces().change(surfaces().list().active, [](model::ListedSurface& outer) { outer.opacity = 0.4; });
    pick(pixelOf(2));
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.5 && pieces().selected.has_value(); }))
        << "what is seen through it is meant";
    EXPECT_EQ(*pieces().selected, piece(2).id);
}

// A key or a click hides the last surface: the view states why it is empty, and the way back.
TEST_F(SurfacesWithPiecesTest, TheViewStatesThatAllSurfacesAreHidden) {
    const auto note = [this] {
        const auto* label = child<QLabel>("hiddenPiecesNote");
        return label->isVisible() ? label->text().toStdString() : std::string();
    };
    addAt(1.0);
    EXPECT_EQ(note(), "");
    QTest::keyClick(window_.get(), Qt::Key_S);
    EXPECT_EQ(note(), "") << "the other one is seen";
    activateNext();
    QTest::keyClick(window_.get(), Qt::Key_S);
    EXPECT_EQ(note(), "All surfaces are hidden. Show the active one: S");
    keepPicture(*window_, "all_surfaces_hidden");
    QTest::keyClick(window_.get(), Qt::Key_S);
    EXPECT_EQ(note(), "");
    showOnly(1); // the active one is not seen, and all of its pieces are hidden
    auto options = view().options();
    options.pieces.leastSize = 1e6;
    view().setOptions(options);
    EXPECT_EQ(note(), "") << "nothing is missed";
    QTest::keyClick(window_.get(), Qt::Key_S);
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->pieces != nullptr; }));
    EXPECT_TRUE(waitUntil([&] { return note().find("All pieces are hidden") == 0; })) << note();
}

TEST_F(SurfacesWithPiecesTest, ARightClickMeansTheActiveOneThoughItIsSeenThrough) {
    addAt(1.0); // larger cones around the first ones, active
    surfaces().change(surfaces().list().active, [](model::ListedSurface& outer) {
        outer.opacity = 0.3;
        outer.name = "Skin & more";
    });
    const auto titleAt = [this](QPoint place) {
        QTest::mouseClick(&viewport(), Qt::RightButton, {}, place);
        EXPECT_TRUE(waitUntil([] { return QApplication::activePopupWidget() != nullptr; }));
        auto* menu = qobject_cast<QMenu*>(QApplication::activePopupWidget());
        if (menu == nullptr || menu->actions().isEmpty())
            return std::string();
        keepPicture(*menu, "view_menu_title");
        const QAction* title = menu->actions().front();
        EXPECT_FALSE(title->isEnabled()) << "it is no command";
        const std::string text = title->text().toStdString();
        menu->close(); // and is deleted
        return text;
    };
    const auto numbered = [this](std::size_t place) { return std::to_string(piece(place).id.number() + 1); };
    const std::string outer = titleAt(pixelOf(1)); // from then on pieces are known
    EXPECT_EQ(outer, "Skin && more: piece " + numbered(1));
    EXPECT_EQ(session_->frame()->isovalue, 1.0) << "the outer one is still active";
    ASSERT_TRUE(pieces().selected);
    EXPECT_EQ(*pieces().selected, piece(1).id);
    EXPECT_EQ(titleAt({4, 4}), "Skin && more") << "no piece is there";
    activateNext(); // the inner one is seen through the other
    const std::string inner = titleAt(pixelOf(2));
    EXPECT_EQ(inner, "Surface 1: piece " + numbered(2));
    EXPECT_EQ(session_->frame()->isovalue, 1.5);
}

TEST_F(SurfacesWithPiecesTest, AllThatIsShownIsExportedAFileForEach) {
    hide(1);
    const auto ofFirst = piece(0).triangles + piece(2).triangles;
    addAt(1.0);
    ASSERT_TRUE(action("pieces.exportShown")->isEnabled());
    dialogs_.answers.push_back(qpath(folder_ / "shown.obj"));
    folder_.write("shown_Surface_1.obj", "not to be replaced");
    action("pieces.exportShown")->trigger();
    EXPECT_TRUE(dialogs_.asked.title.contains(QLatin1Char('2'))) << dialogs_.asked.title.toStdString();
    const auto second = folder_ / "shown_Surface_1_2.obj";
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(second); }));
    ASSERT_TRUE(waitUntilSettled());
    const auto facesOf = [](const std::filesystem::path& path) {
        std::ifstream text(path);
        std::string line;
        std::uint64_t faces = 0;
        while (std::getline(text, line))
            faces += line.rfind("f ", 0) == 0;
        return faces;
    };
    EXPECT_EQ(facesOf(folder_ / "shown.obj"), session_->frame()->stats.triangles);
    EXPECT_EQ(facesOf(second), ofFirst);
    EXPECT_EQ(std::filesystem::file_size(folder_ / "shown_Surface_1.obj"), 18u);
    showOnly(1);
    dialogs_.answers.push_back(qpath(folder_ / "only.obj"));
    EXPECT_FALSE(action("pieces.exportShown")->isEnabled()) << "the whole of one surface: that is Export Mesh";
    dialogs_.answers.clear();
}

TEST_F(SurfacesWithPiecesTest, FitShowsAllSurfacesThatAreShown) {
    addAt(2.5); // small tips of the cones
    const auto radiusOf = [this] {
        const auto before = viewport().camera().pose();
        QTest::keyClick(window_.get(), Qt::Key_F);
        EXPECT_TRUE(waitUntil([&] { return viewport().camera().pose() != before; }));
        QTest::qWait(600); // the camera flies
        return viewport().camera().distance();
    };
    const double both = radiusOf();
    showOnly(1);
    const double one = radiusOf();
    EXPECT_LT(one, 0.95 * both);
    showOnly(0);
    EXPECT_NEAR(radiusOf(), both, 0.02 * both) << "the larger one holds the smaller one";
}

TEST_F(SurfacesWithPiecesTest, UndoBringsEachBackAsItWas) {
    hide(1);
    addAt(1.0);
    showOnly(1); // else the smaller cones of the first, seen through it, are meant
    letStepEnd();
    hide(2);
    const auto first = hiddenOf(0), second = hiddenOf(1);
    ASSERT_EQ(second.hidden.size(), 1u);
    QTest::keyClick(window_.get(), Qt::Key_Delete, Qt::ShiftModifier);
    letStepEnd();
    ASSERT_EQ(surfaces().list().surfaces.size(), 1u);
    EXPECT_EQ(pieces().hiddenPieces(), first);
    const auto undo = [this] {
        QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
        ASSERT_TRUE(waitUntilSettled());
    };
    undo(); // the removal
    EXPECT_EQ(pieces().hiddenPieces(), second);
    EXPECT_EQ(hiddenOf(0), first);
    EXPECT_EQ(seen(), (Seen{true, true, false}));
    EXPECT_EQ(action("edit.undo")->text(), QStringLiteral("&Undo Pieces"));
    undo();
    EXPECT_FALSE(pieces().hidesAny());
    undo(); // showing one only
    undo(); // the slide
    undo(); // adding it
    ASSERT_EQ(surfaces().list().surfaces.size(), 1u);
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.5; }));
    EXPECT_EQ(pieces().hiddenPieces(), first);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    undo();
    EXPECT_FALSE(pieces().hidesAny());
    EXPECT_EQ(seen(), (Seen{true, true, true}));
}

TEST_F(SurfacesWithPiecesTest, ASessionKeepsWhatEachHides) {
    hide(1);
    addAt(1.0);
    showOnly(1); // as above
    letStepEnd();
    hide(0);
    surfaces().change(surfaces().list().surfaces[0].id, [](model::ListedSurface& first) { first.isVisible = true; });
    ASSERT_TRUE(waitUntilSettled());
    const auto sizesOf = [this](std::size_t surface) {
        std::vector<std::uint64_t> sizes;
        if (const auto known = session_->piecesOf(surfaces().list().surfaces[surface].id))
            for (const extract::Piece& each : known->pieces())
                sizes.push_back(each.triangles);
        return sizes;
    };
    const std::array before{sizesOf(0), sizesOf(1)};
    EXPECT_EQ(before[0].size(), 3u);
    EXPECT_EQ(before[1].size(), 3u);
    const auto path = folder_ / "two.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(path); }));
    trigger("file.close");
    window_->openFile(QString::fromStdString(path.string()));
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
    ASSERT_TRUE(waitUntilSettled());
    ASSERT_TRUE(waitUntil([this] { return hiddenOf(0).awaited.isEmpty() && hiddenOf(1).awaited.isEmpty(); }));
    ASSERT_TRUE(waitUntilSettled());
    letStepEnd();
    EXPECT_FALSE(action("edit.undo")->isEnabled()) << "nobody did it";
    EXPECT_EQ(hiddenOf(0).hidden.size(), 1u);
    EXPECT_EQ(hiddenOf(1).hidden.size(), 1u);
    EXPECT_EQ(sizesOf(0), before[0]) << "the pieces of each are as they were";
    EXPECT_EQ(sizesOf(1), before[1]);
    QTest::keyClick(window_.get(), Qt::Key_1);
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
}

TEST_F(SurfacesWithPiecesTest, SlicesHaveContoursOfWhatIsShown) {
    window_->slices().change([](model::SliceOptions& options) { options.layout = model::SliceLayout::Three; });
    hide(1);
    addAt(1.0);
    ASSERT_TRUE(waitUntil([this] { return window_->slices().isSettled(); }));
    const auto contour = window_->slices().contour(model::SliceKind::Z);
    ASSERT_NE(contour, nullptr);
    ASSERT_EQ(contour->parts.size(), 2u);
    const auto pointsNear = [&](int cone, std::size_t part) {
        int count = 0;
        const std::size_t begin = part == 0 ? 0 : contour->parts[part - 1].pointEnd;
        for (std::size_t k = begin; k < contour->parts[part].pointEnd; ++k)
            count += std::abs(contour->points[k].x - 7.0f - 12.5f * static_cast<float>(cone)) < 5.0f;
        return count;
    };
    EXPECT_GT(pointsNear(0, 0), 10);
    EXPECT_EQ(pointsNear(1, 0), 0) << "it is hidden";
    EXPECT_GT(pointsNear(2, 0), 10);
    EXPECT_GT(pointsNear(1, 1), 10) << "of the other surface it is shown";
    EXPECT_NE(contour->parts[0].colour, contour->parts[1].colour);
    keepPicture(*window_, "contours_of_two_surfaces");
}

// "Show all" takes the numbers of pieces with it only if nobody asks for them.
TEST_F(SurfacesWithPiecesTest, ShowingAllIsUndone) {
    hide(1);
    QTest::keyClick(window_.get(), Qt::Key_H, Qt::ControlModifier | Qt::ShiftModifier);
    letStepEnd();
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    slideTo(1.6);
    letStepEnd();
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(seen(), (Seen{true, false, true}));
}

} // namespace
} // namespace isoslider::test

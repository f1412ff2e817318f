#include "ui/model/surface/detail_model.h"

#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

using Measure = DetailModel::Measure;

TEST(DetailModel, TellsObserversOfAnErrorThatDiffers) {
    DetailModel detail;
    int told = 0;
    const auto subscription = detail.observe([&] { ++told; });
    detail.setError({Measure::Distance, 0.0});
    EXPECT_EQ(told, 0) << "it has none";
    detail.setError({Measure::Distance, 0.25});
    detail.setError({Measure::Distance, 0.25});
    EXPECT_EQ(told, 1);
    detail.setError({Measure::Scalar, 0.25});
    EXPECT_EQ(told, 2) << "percent are no cells";
    for (const double amount :
         {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        detail.setError({Measure::Distance, amount});
    EXPECT_EQ(told, 2);
    EXPECT_EQ(detail.error(), (extract::MergeError{Measure::Scalar, 0.25}));
}

TEST(DetailModel, ClearsTheErrorAndKeepsItsMeasure) {
    DetailModel detail;
    detail.setError({Measure::Scalar, 0.5});
    int told = 0;
    const auto subscription = detail.observe([&] { ++told; });
    detail.clearError();
    EXPECT_EQ(detail.error(), (extract::MergeError{Measure::Scalar, 0.0}));
    detail.clearError();
    EXPECT_EQ(told, 1);
}

TEST(DetailModel, UsesACoarserErrorWhileMovingIfThatIsWanted) {
    DetailModel detail;
    int told = 0;
    const auto subscription = detail.observe([&] { ++told; });
    detail.setMoving(true);
    EXPECT_EQ(detail.usedError(), detail.error());
    EXPECT_EQ(told, 0);
    detail.setCoarserWhileMoving(true);
    EXPECT_EQ(told, 1);
    EXPECT_EQ(detail.usedError(), (extract::MergeError{DetailModel::Measure::Distance, 0.5}));
    detail.setMoving(false);
    EXPECT_EQ(told, 2);
    EXPECT_EQ(detail.usedError(), detail.error());
    detail.setError({DetailModel::Measure::Scalar, 0.8});
    detail.setMoving(true);
    EXPECT_EQ(detail.usedError(), (extract::MergeError{DetailModel::Measure::Scalar, 1.6}));
    EXPECT_EQ(detail.error().amount, 0.8);
    detail.setMoving(true);
    EXPECT_EQ(told, 4) << "nothing has changed";
}

TEST(DetailModel, OffersErrorsFromNoneToTwoPercentOrOneCell) {
    for (const Measure measure : {Measure::Scalar, Measure::Distance}) {
        const auto all = DetailModel::choices(measure);
        EXPECT_EQ(all.front(), 0.0);
        EXPECT_EQ(all.back(), measure == Measure::Scalar ? 2.0 : 1.0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(DetailModel::nearestChoice({measure, all[i]}), i);
            if (i > 0) {
                EXPECT_LT(all[i - 1], all[i]);
            }
        }
        EXPECT_EQ(DetailModel::nearestChoice({measure, 1e9}), all.size() - 1);
    }
    EXPECT_EQ(DetailModel::choices(Measure::Scalar).size(), DetailModel::choices(Measure::Distance).size())
        << "one slider has both";
}

TEST(DetailModel, NamesErrors) {
    EXPECT_EQ(DetailModel::text({Measure::Distance, 0.0}), "none");
    EXPECT_EQ(DetailModel::text({Measure::Distance, 0.25}), "0.25 cells");
    EXPECT_EQ(DetailModel::text({Measure::Distance, 1.0}), "1 cell");
    EXPECT_EQ(DetailModel::text({Measure::Scalar, 1.0}), "1 %");
}

} // namespace
} // namespace isoslider::model

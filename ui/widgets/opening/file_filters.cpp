#include "ui/widgets/opening/file_filters.h"

#include <array>
#include <utility>

#include <QCoreApplication>
#include <QStringList>

namespace isoslider::widgets {
namespace {

using Filter = std::pair<const char*, const char*>;

constexpr std::array<Filter, 11> kVolumes{{{"MetaImage", "*.mha *.mhd"},
                                           {"NRRD", "*.nrrd *.nhdr"},
                                           {"NIfTI", "*.nii *.nii.gz *.hdr"},
                                           {"VTK", "*.vti *.vts *.vtu *.vtr *.vtk"},
                                           {"DICOM", "*.dcm"},
                                           {"PLOT3D", "*.xyz *.x *.q *.bin"},
                                           {"TIFF", "*.tif *.tiff"},
                                           {"HDF5 / NetCDF", "*.h5 *.hdf5 *.nc"},
                                           {"Density maps", "*.mrc *.map *.ccp4 *.cube"},
                                           {"Raw samples", "*.raw *.dat"},
                                           {"ISOSLIDER", "*.isx"}}};
constexpr std::array<Filter, 5> kMeshes{
    {{"Stanford PLY", "*.ply"}, {"Wavefront OBJ", "*.obj"}, {"STL", "*.stl"}, {"OFF", "*.off"}, {"OpenMesh", "*.om"}}};

QString filtersOf(const QString& title, const QStringList& further) {
    QStringList all, each;
    for (const auto& [name, patterns] : kVolumes) {
        all << QLatin1String(patterns);
        each << QStringLiteral("%1 (%2)").arg(QLatin1String(name), QLatin1String(patterns));
    }
    all << further;
    each.prepend(QStringLiteral("%1 (%2)").arg(title, all.join(QLatin1Char(' '))));
    each.append(QCoreApplication::translate("FileFilters", "All files (*)"));
    return each.join(QStringLiteral(";;"));
}

} // namespace

QString volumeFilters() { return filtersOf(QCoreApplication::translate("FileFilters", "Volumes and indexes"), {}); }

QString volumeAndSessionFilters() {
    return filtersOf(QCoreApplication::translate("FileFilters", "Volumes, indexes and sessions"),
                     {QStringLiteral("*.isosession")});
}

QString rawFilters() {
    return QCoreApplication::translate("FileFilters", "All files (*);;Raw samples (*.raw *.dat *.bin *.img *.vol)");
}

QString sessionFilters() { return QCoreApplication::translate("FileFilters", "Sessions (*.isosession)"); }

QString meshFilters() {
    QStringList each;
    for (const auto& [name, patterns] : kMeshes)
        each << QStringLiteral("%1 (%2)").arg(QLatin1String(name), QLatin1String(patterns));
    return each.join(QStringLiteral(";;"));
}

} // namespace isoslider::widgets

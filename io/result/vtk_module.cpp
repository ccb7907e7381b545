// The VTK half of vtk.cpp, built as a module of its own. VTK lives here and nowhere else. Vectors of two components get
// a third, 0, since ParaView warps by three; other fields are lent to VTK, not copied. Data are appended in raw form
// without compression. Exceptions end here: a function returns false.

#include "io/result/vtk_module.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <exception>
#include <string>

namespace {

/// Two components become three: ParaView warps by 3-vectors only.
vtkSmartPointer<vtkDoubleArray> array_of(const KerfVtkField& field) {
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(field.name);
  array->SetNumberOfComponents(field.components == 2 ? 3 : field.components);
  if (field.components == 2) {
    array->SetNumberOfTuples(field.count);
    double* to = array->GetPointer(0);
    for (std::int64_t i = 0; i < field.count; ++i) {
      to[3 * i] = field.values[2 * i];
      to[3 * i + 1] = field.values[2 * i + 1];
      to[3 * i + 2] = 0;
    }
  } else {
    // VTK only reads them: the caller's memory is lent, not copied.
    array->SetArray(const_cast<double*>(field.values), field.count * field.components, 1);
  }
  static constexpr const char* four[] = {"xx", "yy", "xy", "yx"};
  if (field.components == 3 || field.components == 4) {
    for (int k = 0; k < field.components; ++k) array->SetComponentName(k, four[k]);
  }
  return array;
}

template <typename DataSet>
void add_points_and_fields(const KerfVtkData& data, DataSet& set) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(data.points);
  for (std::int64_t i = 0; i < data.points; ++i) points->SetPoint(i, data.xy[2 * i], data.xy[2 * i + 1], 0);
  set.SetPoints(points);
  for (std::int64_t i = 0; i < data.fields; ++i) {
    const auto array = array_of(data.field[i]);
    if (data.field[i].per_cell) {
      set.GetCellData()->AddArray(array);
    } else {
      set.GetPointData()->AddArray(array);
    }
  }
}

vtkSmartPointer<vtkCellArray> cells_of(const KerfVtkData& data) {
  const auto end = [&](std::int64_t cell) {
    return cell < 0 ? 0 : data.cell_ends ? data.cell_ends[cell] : static_cast<std::int32_t>(3 * (cell + 1));
  };
  vtkNew<vtkTypeInt32Array> offsets, entries;
  offsets->SetNumberOfValues(data.cells + 1);
  for (std::int64_t k = 0; k <= data.cells; ++k) offsets->SetValue(k, end(k - 1));
  entries->SetNumberOfValues(end(data.cells - 1));
  std::copy_n(data.entries, entries->GetNumberOfValues(), entries->GetPointer(0));
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, entries);
  return cells;
}

template <typename Writer, typename DataSet>
bool write(DataSet& set, KerfVtkSink sink, void* target) {
  vtkObject::GlobalWarningDisplayOff();
  vtkNew<Writer> writer;
  writer->SetInputData(&set);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  // 400k triangles, 10 fields of doubles: raw 0.15 s, 52 MB; zlib level 1 0.86 s, 41 MB. Doubles hardly compress.
  writer->SetCompressorTypeToNone();
  writer->WriteToOutputStringOn();
  if (!writer->Write()) return false;
  const std::string bytes = writer->GetOutputString();
  sink(target, bytes.data(), static_cast<std::int64_t>(bytes.size()));
  return true;
}

}  // namespace

extern "C" bool kerf_vtk_write_triangles(const KerfVtkData* data, KerfVtkSink sink, void* target) {
  try {
    vtkNew<vtkUnstructuredGrid> grid;
    add_points_and_fields(*data, *grid);
    if (data->cell_ends) {
      vtkNew<vtkUnsignedCharArray> types;
      types->SetNumberOfValues(data->cells);
      for (std::int64_t k = 0; k < data->cells; ++k) {
        const std::int32_t corners = data->cell_ends[k] - (k > 0 ? data->cell_ends[k - 1] : 0);
        types->SetValue(k, corners == 3 ? VTK_TRIANGLE : VTK_QUADRATIC_TRIANGLE);
      }
      grid->SetCells(types, cells_of(*data));
    } else {
      grid->SetCells(VTK_TRIANGLE, cells_of(*data));
    }
    return write<vtkXMLUnstructuredGridWriter>(*grid, sink, target);
  } catch (const std::exception&) {
    return false;
  }
}

extern "C" bool kerf_vtk_write_lines(const KerfVtkData* data, KerfVtkSink sink, void* target) {
  try {
    vtkNew<vtkPolyData> lines;
    add_points_and_fields(*data, *lines);
    const bool lone = data->points == data->cells;  // a line of one point is drawn as a vertex alone
    if (lone)
      lines->SetVerts(cells_of(*data));
    else
      lines->SetLines(cells_of(*data));
    return write<vtkXMLPolyDataWriter>(*lines, sink, target);
  } catch (const std::exception&) {
    return false;
  }
}

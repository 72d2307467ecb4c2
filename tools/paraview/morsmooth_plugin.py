"""ParaView plugin: "Morsmooth Smooth", "Morsmooth Simplify" and "Morsmooth Persistence Diagram".

Load it in Tools > Manage Plugins > Load New, or with LoadPlugin("morsmooth_plugin.py", ns=globals()) in pvpython and pvbatch.

The filters call the Python package morsmooth in this process: no temporary files, progress step by step, and Abort works. It must be
on the path of ParaView's Python: pip install --target DIR ./tools/python (with any Python from 3.9 on), then PYTHONPATH=DIR.
README.md beside this file has the commands, and the one line that Debian's ParaView 5.11 needs to load any Python plugin.
"""

from paraview.util.vtkAlgorithm import smhint, smproperty, smproxy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkIntArray, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSet, vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkParallelCore import vtkCommunicator, vtkMultiProcessController

paraview_plugin_name = "Morsmooth"
paraview_plugin_version = "0.1.0"

MENU = '<ShowInMenu category="Morsmooth" />'

INPUT = """
<InputProperty name="Input" command="SetInputConnection">
  <ProxyGroupDomain name="groups"><Group name="sources" /><Group name="filters" /></ProxyGroupDomain>
  <DataTypeDomain name="input_type"><DataType value="vtkDataSet" /></DataTypeDomain>
  <InputArrayDomain name="input_array" attribute_type="point" number_of_components="1" />
  <Documentation>Grid or mesh with a scalar point array. Cells are cut into triangles or tetrahedra.</Documentation>
</InputProperty>
<StringVectorProperty name="Scalars" label="Scalars" command="SetInputArrayToProcess" number_of_elements="5"
    element_types="0 0 0 0 2" animateable="0">
  <ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="input_array">
    <RequiredProperties><Property name="Input" function="Input" /></RequiredProperties>
  </ArrayListDomain>
  <Documentation>Point array to work on. NaN marks holes.</Documentation>
</StringVectorProperty>
<StringVectorProperty name="Mask" label="Mask" command="SetMask" number_of_elements="1" default_values="">
  <Documentation>Name of a point or cell array whose zeros are holes in the domain; empty for none. Hidden points and cells of the
  data set are holes as well.</Documentation>
</StringVectorProperty>
<IntVectorProperty name="Threads" label="Threads" command="SetThreads" number_of_elements="1" default_values="0"
    panel_visibility="advanced">
  <IntRangeDomain name="range" min="0" />
  <Documentation>Threads to use; 0 for all cores. The result has the same bits for any number.</Documentation>
</IntVectorProperty>
"""

SELECTION = """
<IntVectorProperty name="Criterion" label="Keep Extrema By" command="SetCriterion" number_of_elements="1" default_values="0">
  <EnumerationDomain name="enum">
    <Entry value="0" text="Persistence as part of the range" />
    <Entry value="1" text="Persistence as value" />
    <Entry value="2" text="Number of extrema" />
  </EnumerationDomain>
  <Documentation>Which minima and maxima the result has: those whose persistence exceeds a part of the range, or a value, or the
  most persistent ones.</Documentation>
</IntVectorProperty>
<DoubleVectorProperty name="Persistence" label="Persistence" command="SetPersistence" number_of_elements="1" default_values="0.1">
  <DoubleRangeDomain name="range" min="0" />
  <Documentation>Threshold, as a part of the range from 0 to 1, or in the units of the array.</Documentation>
  <Hints><PropertyWidgetDecorator type="GenericDecorator" mode="visibility" property="Criterion" value="2" inverse="1" /></Hints>
</DoubleVectorProperty>
<IntVectorProperty name="Extrema" label="Extrema" command="SetExtrema" number_of_elements="1" default_values="10">
  <IntRangeDomain name="range" min="0" />
  <Documentation>So many extrema, minima and maxima together.</Documentation>
  <Hints><PropertyWidgetDecorator type="GenericDecorator" mode="visibility" property="Criterion" value="2" /></Hints>
</IntVectorProperty>
<StringVectorProperty name="OutputArray" label="Output Array" command="SetOutputArray" number_of_elements="1" default_values="">
  <Documentation>Name of the new array; if empty, that of the scalars with _smooth or _simplified.</Documentation>
</StringVectorProperty>
"""

SMOOTHING = """
<IntVectorProperty name="Order" label="Order" command="SetOrder" number_of_elements="1" default_values="2">
  <IntRangeDomain name="range" min="1" max="4" />
  <Documentation>Order of the polyharmonic energy, 1 to 4: 2 gives smooth, 3 very smooth fields.</Documentation>
</IntVectorProperty>
<DoubleVectorProperty name="Length" label="Length" command="SetLength" number_of_elements="1" default_values="0">
  <DoubleRangeDomain name="range" min="0" max="1" />
  <Documentation>Smoothing length as a part of the diagonal of the bounding box; 0 chooses it from the noise by generalised
  cross-validation.</Documentation>
</DoubleVectorProperty>
<IntVectorProperty name="MeasureOn" label="Measure Extrema On" command="SetMeasureOn" number_of_elements="1" default_values="0">
  <EnumerationDomain name="enum">
    <Entry value="0" text="Data" />
    <Entry value="1" text="Smooth field" />
  </EnumerationDomain>
  <Documentation>The field on which persistence is measured and whose values the extrema keep: the data, if they are trusted, or the
  unconstrained smooth field, if they are noisy.</Documentation>
</IntVectorProperty>
<IntVectorProperty name="FreeValues" label="Free Values At Extrema" command="SetFreeValues" number_of_elements="1" default_values="0"
    panel_visibility="advanced">
  <BooleanDomain name="bool" />
  <Documentation>Keep only place and kind of the wanted extrema, not their values.</Documentation>
</IntVectorProperty>
"""

EMBEDDING = """
<IntVectorProperty name="Embed" label="Embed In Domain" command="SetEmbed" number_of_elements="1" default_values="0">
  <BooleanDomain name="bool" />
  <Documentation>Put the ends of the pairs at their places in the domain, not into the plane of birth and death.</Documentation>
</IntVectorProperty>
"""


def documented(text):
    return f"<Documentation>{text}</Documentation>"


def morsmooth():
    """The package, or an error that says how to get it."""
    try:
        import morsmooth
    except ImportError as error:
        raise RuntimeError(
            f"the Python package morsmooth cannot be imported ({error}); install it for ParaView's Python: pip install --target DIR "
            "./tools/python, and start ParaView with PYTHONPATH=DIR"
        ) from error
    return morsmooth


def processes():
    """Number of this process, and how many there are."""
    controller = vtkMultiProcessController.GetGlobalController()
    return (controller.GetLocalProcessId(), controller.GetNumberOfProcesses(), controller) if controller else (0, 1, None)


class Aborted(Exception):
    pass


class MorsmoothFilter(VTKPythonAlgorithmBase):
    """What the filters share: which array, which mask, one data set as a whole, progress."""

    def __init__(self, output):
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkDataSet", outputType=output)
        self.options = {"Mask": "", "Threads": 0}

    def _set(self, name, value):
        if self.options.get(name) != value:
            self.options[name] = value
            self.Modified()

    def SetMask(self, name):
        self._set("Mask", name or "")

    def SetThreads(self, threads):
        self._set("Threads", threads)

    def FillInputPortInformation(self, port, info):
        info.Set(self.INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet")
        return 1

    def RequestUpdateExtent(self, request, inputs, outputs):
        # Extrema are a matter of the whole domain: one process asks for all of it, the others for nothing.
        rank, count, _ = processes()
        if count > 1:
            info = inputs[0].GetInformationObject(0)
            info.Set(Pipeline.UPDATE_NUMBER_OF_PIECES(), 1)
            info.Set(Pipeline.UPDATE_PIECE_NUMBER(), 0 if rank == 0 else 1)
            info.Set(Pipeline.UPDATE_NUMBER_OF_GHOST_LEVELS(), 0)
            if info.Has(Pipeline.WHOLE_EXTENT()):
                whole = list(info.Get(Pipeline.WHOLE_EXTENT()))
                info.Set(Pipeline.UPDATE_EXTENT(), whole if rank == 0 else [0, -1, 0, -1, 0, -1], 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        given = vtkDataSet.GetData(inputs[0])
        target = vtkDataObject.GetData(outputs)
        self._refuse_pieces(given)
        if given.GetNumberOfPoints() == 0:
            return 1
        self._doubt_cuts(morsmooth(), given)
        name = self.GetInputArrayInformation(0).Get(vtkDataObject.FIELD_NAME())
        control = {"mask": self.options["Mask"] or None, "threads": self.options["Threads"] or None, "progress": self._told}
        try:
            target.ShallowCopy(self.compute(morsmooth(), given, name, control))
        except Aborted:
            target.Initialize()
        return 1

    def _refuse_pieces(self, given):
        """Every process calls this, since ParaView updates all of them together."""
        rank, count, controller = processes()
        if count == 1:
            return
        mine, all_of_them = vtkIntArray(), vtkIntArray()
        for array in (mine, all_of_them):
            array.SetNumberOfTuples(1)
        mine.SetValue(0, int(given.GetNumberOfPoints() > 0))
        controller.AllReduce(mine, all_of_them, vtkCommunicator.SUM_OP)
        if all_of_them.GetValue(0) > 1:
            raise RuntimeError(
                f"the data set is spread over {all_of_them.GetValue(0)} processes; expected it on one. A part alone has false extrema "
                "along the cuts. Save it (Save Data, then morsmooth convert merges the pieces) and run the filter in one process, or "
                "spread the time steps of a series instead: tools/paraview/series_mpi.py"
            )

    def _doubt_cuts(self, package, given):
        """Pieces of a parallel file that were read one after the other have their border points twice."""
        if not (given.IsA("vtkUnstructuredGrid") or given.IsA("vtkPolyData")):
            return
        for fault in package.faults(given):
            if fault.is_cut and processes()[1] > 1:
                raise RuntimeError(f"{fault.text}. Pieces that are not joined have false extrema along their borders: morsmooth convert joins them")
            if fault.is_cut:
                vtkOutputWindow.GetInstance().DisplayWarningText(f"Morsmooth: {fault.text}\n")

    def _told(self, text, part):
        self.SetProgressText(text)
        self.UpdateProgress(part)
        if self.GetAbortExecute():
            raise Aborted

    def compute(self, package, given, name, control):
        raise NotImplementedError


class FieldFilter(MorsmoothFilter):
    """A filter that adds an array to what it is given."""

    def __init__(self):
        super().__init__("vtkDataSet")
        self.options.update({"Criterion": 0, "Persistence": 0.1, "Extrema": 10, "OutputArray": ""})

    def SetCriterion(self, criterion):
        self._set("Criterion", criterion)

    def SetPersistence(self, persistence):
        self._set("Persistence", persistence)

    def SetExtrema(self, extrema):
        self._set("Extrema", extrema)

    def SetOutputArray(self, name):
        self._set("OutputArray", name or "")

    def RequestDataObject(self, request, inputs, outputs):
        given, target = vtkDataSet.GetData(inputs[0]), vtkDataObject.GetData(outputs)
        if given is None:
            return 0
        if target is None or not target.IsA(given.GetClassName()):
            outputs.GetInformationObject(0).Set(vtkDataObject.DATA_OBJECT(), given.NewInstance())
        return 1

    def wishes(self):
        options = self.options
        chosen = [
            {"persistence": options["Persistence"]},
            {"persistence_abs": options["Persistence"]},
            {"extrema": options["Extrema"]},
        ]
        return {**chosen[options["Criterion"]], "output_array": options["OutputArray"] or None}


@smproxy.filter(name="MorsmoothSmooth", label="Morsmooth Smooth")
@smhint.xml(MENU)
@smproperty.xml(
    documented(
        "Smooths a scalar field so that it has exactly the wanted minima and maxima and no other, under plain comparison of the values "
        "as they are stored. The new array is audited before it leaves the filter."
    )
    + INPUT
    + SELECTION
    + SMOOTHING
)
class MorsmoothSmooth(FieldFilter):
    def __init__(self):
        super().__init__()
        self.options.update({"Order": 2, "Length": 0.0, "MeasureOn": 0, "FreeValues": 0})

    def SetOrder(self, order):
        self._set("Order", order)

    def SetLength(self, length):
        self._set("Length", length)

    def SetMeasureOn(self, field):
        self._set("MeasureOn", field)

    def SetFreeValues(self, free):
        self._set("FreeValues", free)

    def compute(self, package, given, name, control):
        options = self.options
        return package.smooth(
            given,
            name,
            order=options["Order"],
            length=options["Length"] or None,
            select="smooth" if options["MeasureOn"] else "data",
            extremum_values="free" if options["FreeValues"] else "keep",
            **self.wishes(),
            **control,
        )


@smproxy.filter(name="MorsmoothSimplify", label="Morsmooth Simplify")
@smhint.xml(MENU)
@smproperty.xml(
    documented(
        "Gives a scalar field exactly the wanted minima and maxima without smoothing it: what is removed is filled or cut, with strict "
        "values instead of plateaus."
    )
    + INPUT
    + SELECTION
    + """
<IntVectorProperty name="OrderArray" label="Order Array" command="SetOrderArray" number_of_elements="1" default_values="0"
    panel_visibility="advanced">
  <BooleanDomain name="bool" />
  <Documentation>Add the array NAME_Order as well: the rank of every point, as TTK reads it.</Documentation>
</IntVectorProperty>
"""
)
class MorsmoothSimplify(FieldFilter):
    def __init__(self):
        super().__init__()
        self.options["OrderArray"] = 0

    def SetOrderArray(self, wanted):
        self._set("OrderArray", wanted)

    def compute(self, package, given, name, control):
        return package.simplify(given, name, order_array=bool(self.options["OrderArray"]), **self.wishes(), **control)


@smproxy.filter(name="MorsmoothPersistenceDiagram", label="Morsmooth Persistence Diagram")
@smhint.xml(MENU)
@smproperty.xml(
    documented(
        "The persistence diagram of a scalar field in all dimensions: a line from birth to death for each pair, with the arrays that the "
        "Topology ToolKit gives it."
    )
    + INPUT
    + EMBEDDING
)
class MorsmoothPersistenceDiagram(MorsmoothFilter):
    def __init__(self):
        super().__init__("vtkUnstructuredGrid")
        self.options["Embed"] = 0

    def SetEmbed(self, embed):
        self._set("Embed", embed)

    def RequestDataObject(self, request, inputs, outputs):
        if vtkUnstructuredGrid.GetData(outputs) is None:
            outputs.GetInformationObject(0).Set(vtkDataObject.DATA_OBJECT(), vtkUnstructuredGrid())
        return 1

    def compute(self, package, given, name, control):
        return package.persistence_diagram(given, name, embed=bool(self.options["Embed"]), **control)

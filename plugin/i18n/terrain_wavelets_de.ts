<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de">
<context>
  <name>TerrainWavelets</name>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Analysing (the first run also compiles, up to half a minute)</source>
    <translation>Analyse (der erste Lauf übersetzt auch, bis zu einer halben Minute)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Checking that the input comes back</source>
    <translation>Prüfen, ob die Eingabe zurückkommt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Coarse TIN</source>
    <translation>Grobes TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>GeoPackage (*.gpkg)</source>
    <translation>GeoPackage (*.gpkg)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Layers in the pyramid</source>
    <translation>Layer in der Pyramide</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Measuring the errors of every level</source>
    <translation>Messen der Fehler aller Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>One GeoPackage with everything: the arrays from which every level is rebuilt exactly, and the coarse TIN and details as styled layers.</source>
    <translation>Ein GeoPackage mit allem: die Felder, aus denen jede Stufe exakt wiederkommt, und das grobe TIN und die Details als gestaltete Layer.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Pyramid</source>
    <translation>Pyramide</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>The triangles of the coarsest level, with elevation and slope.</source>
    <translation>Die Dreiecke der gröbsten Stufe, mit Höhe und Neigung.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Which layers the pyramid file has, which is complete without them: the coarse TIN, up to 50,000 vertices, and the details of the coarser levels, up to 80,000 features (auto), those of all levels, the coarse TIN only, or none.</source>
    <translation>Welche Layer die Pyramidendatei hat, die ohne sie vollständig ist: das grobe TIN, bis 50.000 Stützpunkte, und die Details der gröberen Stufen, bis 80.000 Objekte (auto), die aller Stufen, nur das grobe TIN, oder keine.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>{} vertices, {} triangles</source>
    <translation>{} Punkte, {} Dreiecke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>A file, or a point cloud layer of the project, by its name or id: its filter by class and its CRS count. Read by the plugin itself, so no point cloud support in QGIS is needed.</source>
    <translation>Eine Datei, oder ein Punktwolken-Layer des Projekts, mit Namen oder Kennung: sein Filter nach Klassen und sein KBS gelten. Das Plugin liest selbst, QGIS braucht keine Unterstützung für Punktwolken.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Attributes</source>
    <translation>Attribute</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>CRS of the points</source>
    <translation>KBS der Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Classes</source>
    <translation>Klassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Classes are numbers separated by commas, such as 2,9.</source>
    <translation>Klassen sind Zahlen mit Kommas dazwischen, etwa 2,9.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Gaps at the outline only</source>
    <translation>Lücken nur am Rand</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Height of points at one place</source>
    <translation>Höhe von Punkten am selben Ort</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Instead of the CRS in the file, or where it has none.</source>
    <translation>Statt des KBS in der Datei, oder wo sie keines hat.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep all other dimensions</source>
    <translation>Alle übrigen Dimensionen behalten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep points of noise</source>
    <translation>Rauschpunkte behalten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep what is not transformed (GPS time, flags, ...) in the pyramid, so that the reconstructed file has it too.</source>
    <translation>Was nicht transformiert wird (GPS-Zeit, Kennzeichen, ...), in der Pyramide behalten, damit die wiederhergestellte Datei es auch hat.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep withheld points</source>
    <translation>Zurückgehaltene Punkte behalten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Leave out only what such edges open to the outside; gaps inside stay closed.</source>
    <translation>Nur weglassen, was solche Kanten nach außen öffnen; Lücken im Inneren bleiben geschlossen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Let points of the classes 7 and 18 be part of the surface. Otherwise they are only carried, and the reconstructed file has them.</source>
    <translation>Punkte der Klassen 7 und 18 zur Fläche zählen. Sonst werden sie nur mitgeführt, und die wiederhergestellte Datei hat sie.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Longest edge</source>
    <translation>Längste Kante</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Names of further dimensions of the file, separated by commas.</source>
    <translation>Namen weiterer Dimensionen der Datei, mit Kommas dazwischen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 for ground and water. Empty for all points.</source>
    <translation>Nur Punkte dieser ASPRS-Klassen, mit Kommas dazwischen: 2 für den Boden, 2,9 für Boden und Wasser. Leer für alle Punkte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 for ground and water. Empty for those of the ground, if the file has them, else for all.</source>
    <translation>Nur Punkte dieser ASPRS-Klassen, mit Kommas dazwischen: 2 für den Boden, 2,9 für Boden und Wasser. Leer für die des Bodens, wenn die Datei sie nennt, sonst für alle.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Other attributes</source>
    <translation>Weitere Attribute</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Point cloud</source>
    <translation>Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Reading the points</source>
    <translation>Lesen der Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Taken: all points, since none is classified as ground (class 2)</source>
    <translation>Genommen: alle Punkte, denn keiner ist als Boden (Klasse 2) klassifiziert</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Taken: the {} points of the ground (class 2), of {}</source>
    <translation>Genommen: die {} Punkte des Bodens (Klasse 2) von {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>The filter of the layer {} leaves: {}</source>
    <translation>Der Filter des Layers {} lässt übrig: {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>The same for points with the withheld flag.</source>
    <translation>Dasselbe für Punkte mit dem Kennzeichen "withheld".</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Triangles with a longer edge are left out, as gaps of the point cloud; in the unit of x and y, or metres for a geographic CRS. 0 for five times the spacing that 95 % of the points keep; empty to fill the convex hull.</source>
    <translation>Dreiecke mit einer längeren Kante werden als Lücken der Punktwolke weggelassen; in der Einheit von x und y, bei geographischem KBS in Metern. 0 für das Fünffache des Abstands, den 95 % der Punkte einhalten; leer, um die konvexe Hülle zu füllen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Triangulating {} points</source>
    <translation>Triangulieren von {} Punkten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Unpacked by QGIS's pdal_wrench, since lazrs is missing</source>
    <translation>Entpackt vom Programm pdal_wrench von QGIS, da lazrs fehlt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>What is transformed along with the elevation. &lt;i&gt;hag&lt;/i&gt; is the height above the TIN of the ground points (class 2), in the unit of elevation.</source>
    <translation>Was zusammen mit der Höhe transformiert wird. &lt;i&gt;hag&lt;/i&gt; ist die Höhe über dem TIN der Bodenpunkte (Klasse 2), in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Which height points have that share x and y; each of them comes back.</source>
    <translation>Welche Höhe Punkte mit gleichem x und y haben; jeder von ihnen kommt zurück.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{} classes</source>
    <translation>{} Klassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{}: QGIS does not understand the CRS in the file; choose one.</source>
    <translation>{}: QGIS versteht das KBS in der Datei nicht; wählen Sie eines.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{}: its filter leaves none of the classes that are named; change one.</source>
    <translation>{}: sein Filter lässt keine der genannten Klassen übrig; eines davon ändern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: its filter, {}, asks for more than classes; export the layer, or filter by Classification alone.</source>
    <translation>{}: sein Filter, {}, fragt nach mehr als Klassen; den Layer exportieren, oder nur nach Classification filtern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: its filter, {}, lets no class through; change it.</source>
    <translation>{}: sein Filter, {}, lässt keine Klasse durch; ihn ändern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: there is no such file; choose a point cloud.</source>
    <translation>{}: es gibt keine solche Datei; eine Punktwolke wählen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: this layer is of {}, and local LAS, LAZ and COPC files are what is read; export it as one.</source>
    <translation>{}: dieser Layer ist aus {}, gelesen werden lokale LAS-, LAZ- und COPC-Dateien; ihn als eine solche exportieren.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Band</source>
    <translation>Kanal</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Band with the elevations.</source>
    <translation>Kanal mit den Höhen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>DEM</source>
    <translation>DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Raster of elevations, in any CRS; degrees are worked on in a local metric frame. Cells without data become holes.</source>
    <translation>Raster der Höhen, in beliebigem KBS; mit Grad wird in einem örtlichen metrischen Rahmen gerechnet. Zellen ohne Daten werden Löcher.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Reading the DEM</source>
    <translation>Lesen des DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Changed since its analysis: {}</source>
    <translation>Geändert seit der Analyse: {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>GeoPackage that one of the analyses made. Those of this session, temporary ones too, and those with a layer in the project are in the list.</source>
    <translation>GeoPackage, das eine der Analysen erzeugt hat. Die dieser Sitzung, auch temporäre, und die mit einem Layer im Projekt stehen in der Liste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Levels are numbers separated by commas, such as 0,4,8.</source>
    <translation>Stufen sind Zahlen mit Kommas dazwischen, etwa 0,4,8.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Pyramid (*.gpkg)</source>
    <translation>Pyramide (*.gpkg)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Reading the pyramid</source>
    <translation>Lesen der Pyramide</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>{}: there is no such file; choose a pyramid.</source>
    <translation>{}: Diese Datei gibt es nicht; wählen Sie eine Pyramide.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Angles {:.3g} to {:.3g} degrees, edges {:.4g} to {:.4g}, areas to {:.4g}</source>
    <translation>Winkel {:.3g} bis {:.3g} Grad, Kanten {:.4g} bis {:.4g}, Flächen bis {:.4g}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>By how much edges may grow for each unit of distance, from where sizes or the TIN are finer; such as 0.2.</source>
    <translation>Um wie viel Kanten je Einheit der Entfernung wachsen dürfen, von dort aus, wo die Größen oder das TIN feiner sind; etwa 0,2.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Field with the largest area</source>
    <translation>Feld mit der größten Fläche</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Field with the longest edge</source>
    <translation>Feld mit der längsten Kante</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Give a raster of longest edges, or one longest edge, not both.</source>
    <translation>Geben Sie ein Raster der längsten Kanten oder eine längste Kante an, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Give zones of other sizes and a field with their size, or neither.</source>
    <translation>Geben Sie Zonen anderer Größe und ein Feld mit ihrer Größe an, oder keines von beiden.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Growth of edges for a solver</source>
    <translation>Wachstum der Kanten für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>In degrees, at most 30; 25 where another of these bounds is given. Nodes are added to the TIN until all bounds hold. Needs the Python packages cgal and shapely.</source>
    <translation>In Grad, höchstens 30; 25, wenn eine andere dieser Schranken angegeben ist. Dem TIN werden Knoten hinzugefügt, bis alle Schranken eingehalten sind. Braucht die Python-Pakete cgal und shapely.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>In the unit of the CRS, metres for degrees: no edge is longer.</source>
    <translation>In der Einheit des KBS, bei Grad in Metern: keine Kante ist länger.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Instead of one number: the longest edge by place; any where there is no data.</source>
    <translation>Statt einer Zahl: die längste Kante nach Ort; beliebig, wo keine Daten sind.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Its area, in the squared unit of the CRS.</source>
    <translation>Seine Fläche, in der quadrierten Einheit des KBS.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Largest triangle for a solver</source>
    <translation>Größtes Dreieck für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Longest edge for a solver</source>
    <translation>Längste Kante für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Meshing for a solver</source>
    <translation>Vernetzen für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>No two vertices of the TIN are nearer, but for those of outline and lines.</source>
    <translation>Keine zwei Stützpunkte des TIN liegen näher beisammen, außer denen von Umriss und Linien.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Of the zones of other sizes.</source>
    <translation>Der Zonen anderer Größe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Polygons with a longest edge or a largest area of their own; where several overlap, the least counts. The sizes above hold outside.</source>
    <translation>Polygone mit eigener längster Kante oder größter Fläche; wo sich mehrere überlappen, gilt die kleinste. Außerhalb gelten die Größen oben.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Raster of longest edges</source>
    <translation>Raster der längsten Kanten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Shortest edge for a solver</source>
    <translation>Kürzeste Kante für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Smallest angle for a solver</source>
    <translation>Kleinster Winkel für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Zones of other sizes for a solver</source>
    <translation>Zonen anderer Größe für einen Löser</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>A tile of a DEM has a whole number of cells along its side.</source>
    <translation>Die Seite einer Kachel eines DGM hat eine ganze Zahl von Zellen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>DEMs</source>
    <translation>DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Give DEMs or point clouds, one of the two.</source>
    <translation>Geben Sie DGM oder Punktwolken an, eines von beiden.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Instead of the CRS in the files, or where they have none.</source>
    <translation>Statt des KBS in den Dateien, oder wo sie keines haben.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Instead: LAS, LAZ or COPC files of one point format, an &lt;i&gt;ept.json&lt;/i&gt;, or a folder of them. Each is read once, a million points at a time.</source>
    <translation>Stattdessen: LAS-, LAZ- oder COPC-Dateien eines Punktformats, eine &lt;i&gt;ept.json&lt;/i&gt;, oder ein Ordner davon. Jede wird einmal gelesen, eine Million Punkte auf einmal.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the DEMs: the band with the elevations.</source>
    <translation>Der DGM: das Band mit den Höhen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the point clouds: names of dimensions that are transformed along with the elevation, separated by commas, such as intensity. All others come back, too.</source>
    <translation>Der Punktwolken: Namen von Dimensionen, die mit der Höhe transformiert werden, mit Kommas dazwischen, etwa intensity. Alle anderen kommen auch zurück.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the point clouds: only points of these ASPRS classes, separated by commas. Empty for all points.</source>
    <translation>Der Punktwolken: nur Punkte dieser ASPRS-Klassen, mit Kommas dazwischen. Leer für alle Punkte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>One raster of any size, or several with cells in one grid; where they overlap, the first that has data counts. Layers of files on this machine, read as the files are.</source>
    <translation>Ein Raster beliebiger Größe, oder mehrere, deren Zellen in einem Gitter liegen; wo sie sich überlappen, zählt das erste, das Daten hat. Layer von Dateien auf diesem Rechner, gelesen, wie die Dateien sind.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Or point clouds</source>
    <translation>Oder Punktwolken</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: its CRS is {}, that of {} is {}; reproject it.</source>
    <translation>{}: sein KBS ist {}, das von {} ist {}; projizieren Sie es um.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: its properties change which values are nodata, and tiles take the file as it is; export the layer, or take that change back.</source>
    <translation>{}: seine Eigenschaften ändern, welche Werte NoData sind, und Kacheln nehmen die Datei, wie sie ist; exportieren Sie den Layer, oder nehmen Sie die Änderung zurück.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: tiles are made of raster files on this machine, and this layer is none; export it as one.</source>
    <translation>{}: Kacheln werden aus Rasterdateien auf diesem Rechner gemacht, und dieser Layer ist keine; exportieren Sie ihn als eine.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>Analyse DEM</source>
    <translation>DGM analysieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>DEM to a reversible pyramid of TINs with details by scale</source>
    <translation>DGM zu einer umkehrbaren Pyramide von TINs mit Details je Größenordnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>Turns a DEM into a reversible wavelet pyramid: a coarse TIN and one layer of details for each level of resolution, in one GeoPackage. From it &lt;i&gt;Extract level&lt;/i&gt; gives the terrain at any level and &lt;i&gt;Reconstruct&lt;/i&gt; the DEM itself, bit for bit.</source>
    <translation>Macht aus einem DGM eine umkehrbare Wavelet-Pyramide: ein grobes TIN und eine Schicht von Details für jede Auflösungsstufe, in einem GeoPackage. Daraus gibt &lt;i&gt;Stufe entnehmen&lt;/i&gt; das Gelände in jeder Stufe und &lt;i&gt;Wiederherstellen&lt;/i&gt; das DGM selbst, Bit für Bit.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>dem,dtm,raster,tin from dem,pyramid,wavelet,multiresolution,level of detail,analyze</source>
    <translation>dgm,dem,dtm,raster,tin aus dgm,tin from dem,pyramide,pyramid,wavelet,multiresolution,auflösung,level of detail,analyze</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>Analyse point cloud</source>
    <translation>Punktwolke analysieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to a reversible pyramid of TINs with details by scale</source>
    <translation>LAS-, LAZ- oder COPC-Datei zu einer umkehrbaren Pyramide von TINs mit Details je Größenordnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>Triangulates the points of a LAS, LAZ or COPC file and turns them into a reversible wavelet pyramid. Attributes such as class, intensity, colour or height above ground are transformed together with the elevation. &lt;i&gt;Reconstruct&lt;/i&gt; gives the file back with exactly its integers.</source>
    <translation>Trianguliert die Punkte einer LAS-, LAZ- oder COPC-Datei und macht daraus eine umkehrbare Wavelet-Pyramide. Attribute wie Klasse, Intensität, Farbe oder Höhe über Grund werden mit der Höhe transformiert. &lt;i&gt;Wiederherstellen&lt;/i&gt; gibt die Datei mit genau ihren Ganzzahlen zurück.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>las,laz,copc,lidar,point cloud,tin,pyramid,wavelet,multiresolution,analyze</source>
    <translation>las,laz,copc,lidar,punktwolke,point cloud,tin,pyramide,pyramid,wavelet,multiresolution,analyze</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>A line that is laid on the terrain keeps only as many vertices as it needs to be nowhere farther above or below it, in the unit of elevation. Empty for the largest error where that is a stop rule, else for a thousandth of the relief.</source>
    <translation>Eine Linie, die auf das Gelände gelegt wird, behält nur so viele Punkte, wie sie braucht, um nirgends weiter darüber oder darunter zu liegen, in der Einheit der Höhe. Leer für den größten Fehler, wo er die Abbruchregel ist, sonst für ein Tausendstel des Reliefs.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Along breaklines and outline: RMSE {:.4g}, largest error {:.4g}</source>
    <translation>Entlang von Bruchkanten und Rand: RMSE {:.4g}, größter Fehler {:.4g}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Analyse points or TIN</source>
    <translation>Punkte oder TIN analysieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Become edges of the TIN. Without Z they are laid on the TIN of the points, all along; with Z they keep it. Where they cross, they are cut.</source>
    <translation>Werden Kanten des TIN. Ohne Z werden sie durchgehend auf das TIN der Punkte gelegt; mit Z behalten sie es. Wo sie sich kreuzen, werden sie geteilt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Breaklines</source>
    <translation>Bruchkanten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Breaklines and clip polygons are for points; the edges of a triangle layer stay as they are. Take its vertices, or leave them out.</source>
    <translation>Bruchkanten und Schnittpolygone gehören zu Punkten; die Kanten eines Dreieckslayers bleiben, wie sie sind. Nehmen Sie seine Punkte, oder lassen Sie sie weg.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Clip polygon</source>
    <translation>Schnittpolygon</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Field that locks points</source>
    <translation>Feld, das Punkte festhält</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Field with the elevation</source>
    <translation>Feld mit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Keep the vertices of breaklines and of the outline, and so the lines, at every level.</source>
    <translation>Die Punkte der Bruchkanten und des Rands, und damit die Linien, in jeder Stufe behalten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Largest error along breaklines and outline, in the unit of elevation</source>
    <translation>Größter Fehler entlang von Bruchkanten und Rand, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Laying lines on the terrain</source>
    <translation>Legen der Linien auf das Gelände</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Lock breaklines and outline</source>
    <translation>Bruchkanten und Rand festhalten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>No breakline is where the points are; check that the layers overlap, or leave the breaklines out.</source>
    <translation>Keine Bruchkante liegt dort, wo die Punkte sind; prüfen Sie, ob die Layer sich überdecken, oder lassen Sie die Bruchkanten weg.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>No point is inside the clip polygon; check that the layers overlap.</source>
    <translation>Kein Punkt liegt im Schnittpolygon; prüfen Sie, ob die Layer sich überdecken.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Numeric fields of points that are transformed along with the elevation.</source>
    <translation>Zahlenfelder der Punkte, die mit der Höhe transformiert werden.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Of points; empty for the Z of the geometry.</source>
    <translation>Von Punkten; leer für das Z der Geometrie.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Only the terrain inside; its outline becomes edges of the TIN and is laid on the TIN of the points.</source>
    <translation>Nur das Gelände darin; sein Rand wird zu Kanten des TIN und auf das TIN der Punkte gelegt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points or triangles</source>
    <translation>Punkte oder Dreiecke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points whose value is anything but 0, false or NULL stay at every level.</source>
    <translation>Punkte, deren Wert nicht 0, false oder NULL ist, bleiben in jeder Stufe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points with Z or with a field of elevations, or polygons with Z that are all triangles. Of points at the same x and y the lowest is taken.</source>
    <translation>Punkte mit Z oder mit einem Feld der Höhen, oder Polygone mit Z, die alle Dreiecke sind. Von Punkten mit gleichem x und y wird der tiefste genommen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points with breaklines, or triangles, to a reversible pyramid of TINs</source>
    <translation>Punkte mit Bruchkanten, oder Dreiecke, zu einer umkehrbaren Pyramide von TINs</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>RMSE along breaklines and outline, in the unit of elevation</source>
    <translation>RMSE entlang von Bruchkanten und Rand, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Reading the triangles</source>
    <translation>Lesen der Dreiecke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Tolerance along lines without Z</source>
    <translation>Toleranz entlang von Linien ohne Z</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Turns a layer of points or of triangles into a reversible wavelet pyramid. Points are triangulated (Delaunay in plan), with breaklines as edges and clipped to a polygon if wanted. Locked points and the vertices of breaklines stay at every level, where they are and as high as they are.</source>
    <translation>Macht aus einem Layer von Punkten oder Dreiecken eine umkehrbare Wavelet-Pyramide. Punkte werden trianguliert (Delaunay in der Ebene), auf Wunsch mit Bruchkanten als Kanten und auf ein Polygon geschnitten. Festgehaltene Punkte und die Punkte der Bruchkanten bleiben in jeder Stufe, wo und wie hoch sie sind.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>tin,points,triangles,triangulate,delaunay,breaklines,survey,pyramid,wavelet,multiresolution,analyze</source>
    <translation>tin,punkte,dreiecke,triangulieren,bruchkanten,vermessung,points,triangles,triangulate,delaunay,breaklines,survey,pyramide,pyramid,wavelet,multiresolution,analyze</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Change by scale</source>
    <translation>Veränderung nach Größenordnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Earlier DEM</source>
    <translation>Früheres DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Highest change, in the unit of elevation</source>
    <translation>Höchste Veränderung, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>How much terrain has risen since an earlier DEM, all of it and by scale</source>
    <translation>Wie viel sich das Gelände seit einem früheren DGM gehoben hat, im Ganzen und nach Größenordnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>In the CRS of the pyramid, which is of the later survey; its cells may differ.</source>
    <translation>Im KBS der Pyramide, die von der späteren Aufnahme ist; seine Zellen dürfen andere sein.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Lowest change, in the unit of elevation</source>
    <translation>Niedrigste Veränderung, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Mean change, in the unit of elevation</source>
    <translation>Mittlere Veränderung, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Root mean square change, in the unit of elevation</source>
    <translation>Quadratisches Mittel der Veränderung, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Takes an earlier DEM from the terrain of a pyramid, and the difference apart by scale: a landslide or a mound is in the coarse bands, ploughing and the noise of a survey in the fine ones. All bands add up to the change. Analyse the later survey with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;, whose levels mean the same scale everywhere.</source>
    <translation>Zieht ein früheres DGM vom Gelände einer Pyramide ab und zerlegt den Unterschied nach Größenordnungen: Ein Erdrutsch oder eine Aufschüttung ist in den groben Bändern, Pflugspuren und das Rauschen einer Aufnahme in den feinen. Alle Bänder zusammen ergeben die Veränderung. Die spätere Aufnahme wird mit der Partition &lt;i&gt;random&lt;/i&gt; und der Vorhersage &lt;i&gt;plane&lt;/i&gt; analysiert, deren Ebenen überall dieselbe Größenordnung bedeuten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Taking the change apart</source>
    <translation>Zerlege die Veränderung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>The first band is all of the change, in the unit of elevation: red is added, blue taken away. Then what is coarser than all levels, and a band for each scale.</source>
    <translation>Das erste Band ist die ganze Veränderung, in der Einheit der Höhe: rot kam hinzu, blau ging weg. Dann, was gröber als alle Ebenen ist, und je ein Band für jede Größenordnung.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>change,dod,dem of difference,erosion,deposition,scale,time,survey,pyramid,wavelet</source>
    <translation>veränderung,differenzmodell,erosion,ablagerung,größenordnung,zeit,aufnahme,pyramide,wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>spacing {}: {} root mean square, {} to {}</source>
    <translation>Abstand {}: quadratisches Mittel {}, von {} bis {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>All points, with all their dimensions. LAZ needs the Python package lazrs.</source>
    <translation>Alle Punkte, mit allen ihren Dimensionen. LAZ braucht das Python-Paket lazrs.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Classified point cloud</source>
    <translation>Klassifizierte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Classify ground</source>
    <translation>Boden klassifizieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Height tolerance</source>
    <translation>Höhentoleranz</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>LAS (*.las);;LAZ (*.laz)</source>
    <translation>LAS (*.las);;LAZ (*.laz)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>LAS, LAZ or COPC file to the same with its ground points marked</source>
    <translation>LAS-, LAZ- oder COPC-Datei zu derselben mit gekennzeichneten Bodenpunkten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Largest object</source>
    <translation>Größtes Objekt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Least slope</source>
    <translation>Kleinste Neigung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Looking for the ground among {} points</source>
    <translation>Suche den Boden unter {} Punkten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Marks the ground points of a LAS, LAZ or COPC file, from their heights alone and without training: what stands above the lows around it, at any scale, by more than the slope of the ground explains, is no ground. The ground gets class 2, all else 1; noise and withheld points keep their class, and nothing but classes is changed.</source>
    <translation>Kennzeichnet die Bodenpunkte einer LAS-, LAZ- oder COPC-Datei, allein nach ihren Höhen und ohne Training: Was auf irgendeiner Skala weiter über den tiefsten Stellen ringsum steht, als es die Neigung des Bodens erklärt, ist kein Boden. Der Boden erhält Klasse 2, alles andere 1; Rauschen und zurückgehaltene Punkte behalten ihre Klasse, und nur Klassen werden geändert.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points</source>
    <translation>Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points of the ground</source>
    <translation>Punkte des Bodens</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points so far above or below the ground's surface are part of it, in metres.</source>
    <translation>Punkte, die so weit über oder unter der Bodenoberfläche liegen, gehören noch dazu, in Metern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Rise over run that the ground may have everywhere; on slopes more, by itself. Larger values keep more banks and let more low things through.</source>
    <translation>Steigung (Höhe durch Länge), die der Boden überall haben darf; an Hängen von selbst mehr. Größere Werte behalten mehr Böschungen und lassen mehr Niedriges durch.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Width of the largest building, in metres; wider ones are taken for ground.</source>
    <translation>Breite des größten Gebäudes, in Metern; breitere gelten als Boden.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Writing {}</source>
    <translation>Schreiben: {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>ground,ground filter,classify,classification,bare earth,dtm,smrf,csf,las,laz,lidar,point cloud,vegetation,buildings</source>
    <translation>Boden,Bodenfilter,klassifizieren,Klassifizierung,Gelände,DGM,SMRF,CSF,LAS,LAZ,LiDAR,Punktwolke,Vegetation,Gebäude</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>the classified point cloud</source>
    <translation>die klassifizierte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>{} of {} points are ground</source>
    <translation>{} von {} Punkten sind Boden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>&lt;i&gt;kmeans&lt;/i&gt;, or a &lt;i&gt;mixture&lt;/i&gt; of Gaussians of different size and shape.</source>
    <translation>&lt;i&gt;kmeans&lt;/i&gt;, oder eine Mischung (&lt;i&gt;mixture&lt;/i&gt;) von Gauß-Verteilungen verschiedener Größe und Form.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>A raster of labels; each cell has that of the nearest vertex.</source>
    <translation>Ein Raster der Nummern; jede Zelle hat die des nächsten Punkts.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Accuracy in blocks left out, 0 to 1</source>
    <translation>Genauigkeit in ausgelassenen Blöcken, 0 bis 1</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Channels</source>
    <translation>Kanäle</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Channels whose scales count, separated by commas: z and attributes. Empty for the geometry.</source>
    <translation>Kanäle, deren Größenordnungen zählen, mit Kommas dazwischen: z und Attribute. Leer für die Geometrie.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Choose the layer of training areas and its field of classes.</source>
    <translation>Wählen Sie den Layer der Trainingsflächen und sein Feld mit den Klassen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Classes that stand for 'not known', separated by commas.</source>
    <translation>Klassen, die für 'nicht bekannt' stehen, mit Kommas dazwischen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Cluster details</source>
    <translation>Details gruppieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Clustered vertices</source>
    <translation>Gruppierte Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Empty for a number found from the data (2 to 10).</source>
    <translation>Leer für eine Zahl, die aus den Daten gefunden wird (2 bis 10).</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Every input vertex with its label and how clearly it belongs there (0 to 1).</source>
    <translation>Jeder Punkt der Eingabe mit seiner Nummer und wie klar er dazugehört (0 bis 1).</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Field with the class</source>
    <translation>Feld mit der Klasse</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Gathering the spectrum of each vertex, and clustering</source>
    <translation>Sammeln des Spektrums jedes Punkts und Gruppieren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Gathering the spectrum of each vertex, and learning the classes</source>
    <translation>Sammeln des Spektrums jedes Punkts und Lernen der Klassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Groups terrain by its scale signature: how much detail each place has at each level. Without a teacher, places that are alike form clusters, numbered from smooth to rough. With training areas, or with the classes that some points of a LAS file have, the classes are learned and predicted for the rest. Analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt; for levels that mean the same scale everywhere.</source>
    <translation>Gruppiert Gelände nach seiner Größensignatur: wie viel Detail jeder Ort in jeder Stufe hat. Ohne Lehrer bilden ähnliche Orte Gruppen, von glatt bis rau nummeriert. Mit Trainingsflächen, oder mit den Klassen, die einige Punkte einer LAS-Datei haben, werden die Klassen gelernt und für den Rest vorhergesagt. Analysieren Sie mit der Zerlegung &lt;i&gt;random&lt;/i&gt; und der Vorhersage &lt;i&gt;plane&lt;/i&gt;, damit Stufen überall dieselbe Größe bedeuten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>JSON (*.json)</source>
    <translation>JSON (*.json)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>LAS classes are numbers separated by commas, such as 0,1.</source>
    <translation>LAS-Klassen sind Zahlen mit Kommas dazwischen, etwa 0,1.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>LAS classes to predict</source>
    <translation>Vorherzusagende LAS-Klassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Learn from</source>
    <translation>Lernen von</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Map of clusters</source>
    <translation>Karte der Gruppen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Method</source>
    <translation>Verfahren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>No vertex is inside a training area; check that the layers overlap.</source>
    <translation>Kein Punkt liegt in einer Trainingsfläche; prüfen Sie, ob die Layer sich überdecken.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Number of clusters</source>
    <translation>Anzahl der Gruppen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Of the random samples and starts; the same seed gives the same result.</source>
    <translation>Der zufälligen Stichproben und Anfänge; derselbe Wert gibt dasselbe Ergebnis.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Polygons inside which the class is known.</source>
    <translation>Polygone, in denen die Klasse bekannt ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Predict blocks of the map from the others, and say how many of their labels come out right. Takes several times as long.</source>
    <translation>Blöcke der Karte aus den anderen vorhersagen und sagen, wie viele ihrer Nummern stimmen. Dauert ein Mehrfaches.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Report the accuracy</source>
    <translation>Genauigkeit berichten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Seed</source>
    <translation>Startwert</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Size and spectrum of each cluster.</source>
    <translation>Größe und Spektrum jeder Gruppe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Summary of the clusters</source>
    <translation>Zusammenfassung der Gruppen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Terrain grouped into clusters, or classes, by its details at each scale</source>
    <translation>Gelände in Gruppen, oder Klassen, nach seinen Details in jeder Größenordnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Training areas</source>
    <translation>Trainingsflächen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Whether clusters are found, or classes learned, and from what.</source>
    <translation>Ob Gruppen gefunden oder Klassen gelernt werden, und woraus.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Whole numbers from 0 to 254.</source>
    <translation>Ganze Zahlen von 0 bis 254.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>class</source>
    <translation>Klasse</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>cluster</source>
    <translation>Gruppe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>cluster,classification,scale signature,spectrum,landform,k-means,machine learning</source>
    <translation>gruppe,cluster,klassifikation,classification,größensignatur,scale signature,spektrum,spectrum,geländeform,landform,k-means,maschinelles lernen,machine learning</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>0 is the coarsest. Empty for the coarsest whose RMSE is at most a fifth of the interval.</source>
    <translation>0 ist die gröbste. Leer für die gröbste, deren RMSE höchstens ein Fünftel des Höhenabstands ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Base</source>
    <translation>Ausgangshöhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contour lines of one level of a pyramid, the smoother the coarser the level</source>
    <translation>Höhenlinien einer Stufe einer Pyramide, je gröber die Stufe, desto glatter</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contours</source>
    <translation>Höhenlinien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contours of level</source>
    <translation>Höhenlinien der Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Drawing the contours</source>
    <translation>Zeichnen der Höhenlinien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Draws the contours of one level of a pyramid, straight in each triangle and never crossing. A coarse level has few and smooth ones. Higher ground is on the right of a line; every fifth is marked, and drawn thick.</source>
    <translation>Zeichnet die Höhenlinien einer Stufe einer Pyramide, gerade in jedem Dreieck und ohne Kreuzungen. Eine grobe Stufe hat wenige und glatte. Höheres Gelände liegt rechts einer Linie; jede fünfte ist gekennzeichnet und dick gezeichnet.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Height that the intervals are counted from.</source>
    <translation>Höhe, von der an die Abstände zählen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>In the unit of elevation; empty or 0 for a round one that gives about twenty.</source>
    <translation>In der Einheit der Höhe; leer oder 0 für einen runden, der etwa zwanzig gibt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Interval</source>
    <translation>Höhenabstand</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Level</source>
    <translation>Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Level {}, a contour each {:g}</source>
    <translation>Stufe {}, eine Höhenlinie alle {:g}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Lines with Z and the fields &lt;i&gt;elevation&lt;/i&gt; and &lt;i&gt;is_index&lt;/i&gt;.</source>
    <translation>Linien mit Z und den Feldern &lt;i&gt;elevation&lt;/i&gt; und &lt;i&gt;is_index&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Number of contours</source>
    <translation>Anzahl der Höhenlinien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>contour,contours,isolines,lines,elevation,tin,generalise,generalize,smooth,level,wavelet,pyramid</source>
    <translation>höhenlinien,isolinien,contour,contours,isolines,lines,elevation,tin,generalisieren,generalise,generalize,smooth,stufe,level,wavelet,pyramide,pyramid</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>A raster with one band for each level: the root mean square detail around each place, in the unit of elevation. It maps at which scale the terrain is rough.</source>
    <translation>Ein Raster mit einem Kanal je Stufe: das quadratische Mittel der Details um jeden Ort, in der Einheit der Höhe. Es zeigt, in welcher Größenordnung das Gelände rau ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Coarsest level</source>
    <translation>Gröbste Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Degrees between the surface and the smooth one of a scale, averaged over its neighbourhoods. The first band is the largest of all scales, the second the distance on the ground at which it is found; then a band for each scale.</source>
    <translation>Grad zwischen der Oberfläche und der glatten eines Maßstabs, gemittelt über dessen Nachbarschaften. Das erste Band ist der größte Wert aller Maßstäbe, das zweite die Entfernung am Boden, bei der er gefunden wird; dann ein Band für jeden Maßstab.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Detail layers</source>
    <translation>Detail-Layer</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details by level</source>
    <translation>Details nach Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details of this level and coarser ones; empty for all.</source>
    <translation>Details dieser und gröberer Stufen; leer für alle.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details of this level and finer ones.</source>
    <translation>Details dieser und feinerer Stufen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Deviation by scale</source>
    <translation>Abweichung nach Maßstab</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Energy by level</source>
    <translation>Energie nach Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Fields: &lt;i&gt;vertex_id&lt;/i&gt; in the input, &lt;i&gt;level&lt;/i&gt;, &lt;i&gt;w_…&lt;/i&gt; the detail of a channel, &lt;i&gt;magnitude&lt;/i&gt; the length of the detail vector.</source>
    <translation>Felder: &lt;i&gt;vertex_id&lt;/i&gt; in der Eingabe, &lt;i&gt;level&lt;/i&gt; die Stufe, &lt;i&gt;w_…&lt;/i&gt; das Detail eines Kanals, &lt;i&gt;magnitude&lt;/i&gt; die Länge des Detailvektors.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Finest level</source>
    <translation>Feinste Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Gathering the scales</source>
    <translation>Sammeln der Maßstäbe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Height above the surroundings in their standard deviations: above 0 on ridges, below in valleys. The first band is the strongest of all scales, the second the distance on the ground at which it is found; then a band for each scale.</source>
    <translation>Höhe über der Umgebung in deren Standardabweichungen: über 0 auf Rücken, darunter in Tälern. Das erste Band ist der stärkste Wert aller Maßstäbe, das zweite die Entfernung am Boden, bei der er gefunden wird; dann ein Band für jeden Maßstab.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Largest magnitude</source>
    <translation>Größter Betrag</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Leave out points whose detail vector is shorter (in the unit of elevation where elevation alone is lifted).</source>
    <translation>Punkte weglassen, deren Detailvektor kürzer ist (in der Einheit der Höhe, wo nur die Höhe transformiert wird).</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Number of points</source>
    <translation>Anzahl der Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Roughness by scale</source>
    <translation>Rauheit nach Maßstab</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Shows at which scale the terrain has its detail: a point for every vertex that the analysis removed, with the level at which it went and its detail vector (the wavelet coefficients). Points are coloured by level and sized by magnitude, as in Fig. 10b of the paper. Level 0 is the coarsest. For scales that mean the same everywhere, analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;; the default partition takes detail out where it matters least first.</source>
    <translation>Zeigt, in welcher Größenordnung das Gelände seine Details hat: ein Punkt für jeden, den die Analyse entfernt hat, mit der Stufe, in der er ging, und seinem Detailvektor (den Wavelet-Koeffizienten). Die Punkte sind nach Stufe gefärbt und nach Betrag groß, wie in Abb. 10b des Artikels. Stufe 0 ist die gröbste. Damit Größen überall dasselbe bedeuten, analysieren Sie mit der Zerlegung &lt;i&gt;random&lt;/i&gt; und der Vorhersage &lt;i&gt;plane&lt;/i&gt;; die übliche Zerlegung nimmt zuerst heraus, was am wenigsten ausmacht.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Smallest magnitude</source>
    <translation>Kleinster Betrag</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>The coarsest level, {}, is finer than the finest, {}; exchange them.</source>
    <translation>Die gröbste Stufe, {}, ist feiner als die feinste, {}; vertauschen Sie sie.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>The details (wavelet coefficients) of a pyramid as points, and their energy</source>
    <translation>Die Details (Wavelet-Koeffizienten) einer Pyramide als Punkte, und ihre Energie</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>This pyramid has no level, so it has no details.</source>
    <translation>Diese Pyramide hat keine Stufe, also auch keine Details.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>wavelet coefficients,detail,scale,vertex-frequency,points,pyramid</source>
    <translation>wavelet-koeffizienten,wavelet coefficients,detail,größe,scale,vertex-frequency,punkte,points,pyramide,pyramid</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>0 is the coarsest.</source>
    <translation>0 ist die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>A DEM has its own cell size; leave the other one empty.</source>
    <translation>Ein DGM hat seine eigene Zellgröße; die andere leer lassen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>A level of a pyramid less another level, or less a DEM, as a raster</source>
    <translation>Eine Stufe einer Pyramide weniger eine andere, oder weniger ein DGM, als Raster</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>DEM that is subtracted</source>
    <translation>DGM, das abgezogen wird</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Difference of level</source>
    <translation>Differenz einer Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Difference of the surfaces</source>
    <translation>Differenz der Oberflächen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Empty for the input itself, where there is no DEM either.</source>
    <translation>Leer für die Eingabe selbst, wenn auch kein DGM da ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Give a level to subtract or a DEM, not both.</source>
    <translation>Eine Stufe oder ein DGM zum Abziehen angeben, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Highest difference, in the unit of elevation</source>
    <translation>Höchste Differenz, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>In the unit of the CRS, where no DEM is given. Empty for the grid of the DEM that the pyramid was made from, and for points their mean spacing.</source>
    <translation>In der Einheit des KBS, wenn kein DGM angegeben ist. Leer für das Gitter des DGM, aus dem die Pyramide entstand, und bei Punkten ihr mittlerer Abstand.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Instead of a level; in the CRS of the pyramid. The result is on its grid.</source>
    <translation>Statt einer Stufe; im KBS der Pyramide. Das Ergebnis liegt auf seinem Gitter.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Level less the other, in the unit of elevation: red is added, blue taken away.</source>
    <translation>Stufe weniger die andere, in der Einheit der Höhe: Rot kam hinzu, Blau wurde weggenommen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Level that is subtracted</source>
    <translation>Stufe, die abgezogen wird</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Lowest difference, in the unit of elevation</source>
    <translation>Niedrigste Differenz, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Mean difference, in the unit of elevation</source>
    <translation>Mittlere Differenz, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Root mean square difference, in the unit of elevation</source>
    <translation>Quadratisches Mittel der Differenz, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Subtracting the surfaces</source>
    <translation>Abziehen der Oberflächen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Subtracts from the surface of one level that of another one, or a DEM: what a generalisation took away, or how a later survey differs at the scale of the level. Above 0 the level is the higher one.</source>
    <translation>Zieht von der Oberfläche einer Stufe die einer anderen oder ein DGM ab: was eine Generalisierung wegnahm, oder wie sich eine spätere Aufnahme im Maßstab der Stufe unterscheidet. Über 0 liegt die Stufe höher.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>difference,dod,dem of difference,change,error,residual,compare,level,pyramid,wavelet</source>
    <translation>Differenz,DoD,Höhendifferenz,Änderung,Fehler,Residuum,Vergleich,Stufe,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>A region of a tiled pyramid at any level or accuracy, as TIN, raster or mesh</source>
    <translation>Ein Gebiet einer gekachelten Pyramide in beliebiger Stufe oder Genauigkeit, als TIN, Raster oder Netz</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Extent</source>
    <translation>Ausdehnung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Extract from tiles</source>
    <translation>Aus Kacheln entnehmen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Give a level or the largest error, not both.</source>
    <translation>Geben Sie eine Stufe oder den größten Fehler an, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Give an extent or polygons, not both.</source>
    <translation>Geben Sie eine Ausdehnung oder Polygone an, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Gives a region of what &lt;i&gt;Tile large DEM or point clouds&lt;/i&gt; made, at a level or as coarse as a largest error allows, without cracks between tiles. Only the tiles that it needs are read. Triangles that reach into the region are given whole.</source>
    <translation>Gibt ein Gebiet dessen, was &lt;i&gt;Großes DGM oder Punktwolken kacheln&lt;/i&gt; gemacht hat, in einer Stufe oder so grob, wie ein größter Fehler es erlaubt, ohne Risse zwischen Kacheln. Nur die nötigen Kacheln werden gelesen. Dreiecke, die in das Gebiet reichen, kommen ganz.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>In the unit of the CRS. Empty for the mean spacing of the vertices.</source>
    <translation>In der Einheit des KBS. Leer für den mittleren Abstand der Punkte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Index of the tiles</source>
    <translation>Index der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Index of tiles (*.gpkg)</source>
    <translation>Index von Kacheln (*.gpkg)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Instead of a level: fine only where it has to be for no input point of the region to be farther above or below the surface, in the unit of elevation.</source>
    <translation>Statt einer Stufe: nur dort fein, wo es sein muss, damit kein Eingabepunkt des Gebiets weiter über oder unter der Fläche liegt, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Instead: the region is that of all of them. This needs shapely.</source>
    <translation>Stattdessen: das Gebiet ist das von ihnen allen. Dafür ist shapely nötig.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Largest error</source>
    <translation>Größter Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Level, or the finest one in the region</source>
    <translation>Stufe, oder die feinste im Gebiet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Levels: 0 (coarsest) to {}</source>
    <translation>Stufen: 0 (gröbste) bis {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Mesh of the region</source>
    <translation>Netz des Gebiets</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>No output is chosen; choose a TIN, vertices, a raster or a mesh.</source>
    <translation>Keine Ausgabe ist gewählt; wählen Sie ein TIN, Punkte, ein Raster oder ein Netz.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Number of triangles</source>
    <translation>Anzahl der Dreiecke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Number of vertices</source>
    <translation>Anzahl der Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Of the whole: 0 is the coarsest; the number of levels is the input itself.</source>
    <translation>Des Ganzen: 0 ist die gröbste; die Anzahl der Stufen ist die Eingabe selbst.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Or polygons</source>
    <translation>Oder Polygone</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Points with elevation and attributes; &lt;i&gt;vertex_id&lt;/i&gt; counts the input's cells.</source>
    <translation>Punkte mit Höhe und Attributen; &lt;i&gt;vertex_id&lt;/i&gt; zählt die Zellen der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Raster of the region</source>
    <translation>Raster des Gebiets</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Reading the index</source>
    <translation>Lesen des Index</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Reading the tiles</source>
    <translation>Lesen der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>TIN of the region</source>
    <translation>TIN des Gebiets</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The TIN evaluated at the cell centres, 32-bit floats.</source>
    <translation>Das TIN an den Zellmitten, als 32-Bit-Gleitkommazahlen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The file &lt;i&gt;index.gpkg&lt;/i&gt; in the folder of the tiles.</source>
    <translation>Die Datei &lt;i&gt;index.gpkg&lt;/i&gt; im Ordner der Kacheln.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The region, in any CRS. Empty, and no polygons either, for all.</source>
    <translation>Das Gebiet, in beliebigem KBS. Leer, und auch keine Polygone, für alles.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>There is no polygon in the layer; choose another.</source>
    <translation>In dem Layer ist kein Polygon; wählen Sie einen anderen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Tiles and groups that were read</source>
    <translation>Kacheln und Gruppen, die gelesen wurden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Triangles with mean elevation and slope (degrees).</source>
    <translation>Dreiecke mit mittlerer Höhe und Neigung (Grad).</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Vertices of the region</source>
    <translation>Punkte des Gebiets</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>of the surface</source>
    <translation>der Fläche</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>tiles,index,region,clip,extent,tin,mesh,2dm,raster,level of detail,lod,large,pyramid,wavelet</source>
    <translation>Kacheln,Index,Gebiet,zuschneiden,Ausdehnung,TIN,Netz,2dm,Raster,Detailstufe,LOD,groß,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>{}: this is no index of tiles; choose index.gpkg in their folder.</source>
    <translation>{}: das ist kein Index von Kacheln; wählen Sie index.gpkg in ihrem Ordner.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>0 is the coarsest; the number of levels is the input itself. In the dialog, click a row of the table of levels.</source>
    <translation>0 ist die gröbste; die Anzahl der Stufen ist die Eingabe selbst. Im Dialog: eine Zeile der Tabelle der Stufen anklicken.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Extract level</source>
    <translation>Stufe entnehmen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Give one of three: a level, a number of vertices, or the largest error.</source>
    <translation>Geben Sie eines von dreien: eine Stufe, eine Anzahl von Punkten oder den größten Fehler.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made from, and for points the mean spacing of the level's vertices.</source>
    <translation>In der Einheit des KBS. Leer für das Gitter des DGM, aus dem die Pyramide gemacht ist, und bei Punkten für den mittleren Abstand der Punkte der Stufe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Instead of a level: exactly this many, from those of the coarsest level to all.</source>
    <translation>Statt einer Stufe: genau so viele, von denen der gröbsten Stufe bis zu allen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Instead of a level: the smallest size found at which no input point is farther above or below the surface, in the unit of elevation.</source>
    <translation>Statt einer Stufe: die kleinste gefundene Größe, bei der kein Punkt der Eingabe weiter über oder unter der Fläche liegt, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Level, or the finer one of two</source>
    <translation>Stufe, oder die feinere von zweien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Mesh of the level</source>
    <translation>Netz der Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>One level of a pyramid as TIN, points, raster or mesh</source>
    <translation>Eine Stufe einer Pyramide als TIN, Punkte, Raster oder Netz</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Points with elevation and attributes; &lt;i&gt;vertex_id&lt;/i&gt; is that of the input.</source>
    <translation>Punkte mit Höhe und Attributen; &lt;i&gt;vertex_id&lt;/i&gt; ist die der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Raster of the level</source>
    <translation>Raster der Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Rounds of refinement</source>
    <translation>Runden der Verfeinerung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Rounds of refinement are of the largest error; give both or none.</source>
    <translation>Runden der Verfeinerung gehören zum größten Fehler; beides angeben oder keines von beiden.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Synthesises the terrain at one level of a pyramid and gives it as triangles, vertices, a raster or a mesh file for hydraulic models. Instead of a level, give a number of vertices or the largest error, and you get a size between two levels. The log shows how large and how accurate each level is; level 0 is the coarsest.</source>
    <translation>Setzt das Gelände in einer Stufe einer Pyramide zusammen und gibt es als Dreiecke, Punkte, Raster oder als Netzdatei für hydraulische Modelle. Statt einer Stufe geben Sie eine Anzahl von Punkten oder den größten Fehler und erhalten eine Größe zwischen zwei Stufen. Das Protokoll zeigt, wie groß und wie genau jede Stufe ist; Stufe 0 ist die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Synthesising the surface</source>
    <translation>Zusammensetzen der Fläche</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>TIN of the level</source>
    <translation>TIN der Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Vertices of the level</source>
    <translation>Punkte der Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>With the largest error: how often edges are turned, vertices moved, and taken out where it allows. Vertices are then points of the input.</source>
    <translation>Mit dem größten Fehler: wie oft Kanten umgelegt, Stützpunkte verschoben und, wo er es erlaubt, entfernt werden. Stützpunkte sind dann Punkte der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>tin,mesh,2dm,raster,level of detail,lod,generalise,generalize,coarse,wavelet,pyramid</source>
    <translation>tin,netz,mesh,2dm,raster,level of detail,lod,generalisieren,generalise,generalize,grob,coarse,wavelet,pyramide,pyramid</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>&lt;i&gt;difference&lt;/i&gt; for a pyramid that was made from a difference of DEMs: red is above zero, blue below.</source>
    <translation>&lt;i&gt;difference&lt;/i&gt; für eine Pyramide, die aus einer Differenz von DGM entstand: Rot ist über null, Blau darunter.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>A difference of DEMs needs a pyramid that was made from a DEM.</source>
    <translation>Eine Differenz von DGM braucht eine Pyramide, die aus einem DGM gemacht ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>A pyramid file like the input, with the changed details.</source>
    <translation>Eine Pyramidendatei wie die Eingabe, mit den geänderten Details.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Changes chosen scales of the terrain: damps or boosts the details of each level by a gain, keeps a band of levels or of sizes on the ground, or removes noise while banks and ridges stay. It gives the filtered pyramid and the filtered DEM, point cloud or TIN. Noise is removed first, then gains apply.</source>
    <translation>Ändert gewählte Größenordnungen des Geländes: dämpft oder verstärkt die Details jeder Stufe, behält ein Band von Stufen oder von Größen am Boden, oder entfernt Rauschen, während Böschungen und Grate bleiben. Es gibt die gefilterte Pyramide und das gefilterte DGM, die Punktwolke oder das TIN. Zuerst wird das Rauschen entfernt, dann wirken die Verstärkungen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Channels to remove noise from, separated by commas: z and attributes.</source>
    <translation>Kanäle, aus denen Rauschen entfernt wird, mit Kommas dazwischen: z und Attribute.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Choose levels or sizes to keep, not both.</source>
    <translation>Wählen Sie Stufen oder Größen, die bleiben, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Coarsest level kept</source>
    <translation>Gröbste Stufe, die bleibt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Difference of the DEMs</source>
    <translation>Differenz der DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Distance at which the correlation of the noise has fallen to a third, in metres; empty for noise that is white.</source>
    <translation>Abstand, in dem die Korrelation des Rauschens auf ein Drittel gefallen ist, in Metern; leer für weißes Rauschen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop details that are larger on the ground, in the same unit.</source>
    <translation>Details weglassen, die am Boden größer sind, in derselben Einheit.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop details that are smaller on the ground, in the unit of x and y, or metres for a geographic CRS. The pyramid may be of any kind.</source>
    <translation>Details weglassen, die am Boden kleiner sind, in der Einheit von x und y, bei geographischem KBS in Metern. Die Pyramide darf beliebig sein.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop the details of coarser levels.</source>
    <translation>Die Details gröberer Stufen weglassen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop the details of finer levels.</source>
    <translation>Die Details feinerer Stufen weglassen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Estimate the range of the noise</source>
    <translation>Reichweite des Rauschens schätzen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filter levels</source>
    <translation>Stufen filtern</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered DEM</source>
    <translation>Gefiltertes DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered TIN</source>
    <translation>Gefiltertes TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered minus original elevation, for a pyramid of a DEM.</source>
    <translation>Gefilterte weniger ursprüngliche Höhe, bei einer Pyramide aus einem DGM.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered point cloud</source>
    <translation>Gefilterte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered pyramid</source>
    <translation>Gefilterte Pyramide</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtering</source>
    <translation>Filtern</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Finest level kept</source>
    <translation>Feinste Stufe, die bleibt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>From how details fall off over the scales.</source>
    <translation>Daraus, wie die Details über die Größenordnungen abnehmen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gain</source>
    <translation>Verstärkung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gains</source>
    <translation>Verstärkungen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gains are pairs of a level and a number, such as 5 and 0.5.</source>
    <translation>Verstärkungen sind Paare aus einer Stufe und einer Zahl, etwa 5 und 0.5.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>In the unit of elevation; empty to have it estimated from the finest level.</source>
    <translation>In der Einheit der Höhe; leer, um sie aus der feinsten Stufe schätzen zu lassen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Largest change of elevation</source>
    <translation>Größte Änderung der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Largest size kept</source>
    <translation>Größte Größe, die bleibt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Leave out the coarsest surface</source>
    <translation>Die gröbste Fläche weglassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Measure the noise at each place, as on slopes seen by a laser scanner.</source>
    <translation>Das Rauschen an jedem Ort messen, wie an Hängen, die ein Laserscanner sieht.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Noise differs by place</source>
    <translation>Rauschen ist je Ort verschieden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Noise removed from a pyramid, or chosen scales damped, boosted or isolated</source>
    <translation>Rauschen aus einer Pyramide entfernt, oder gewählte Größen gedämpft, verstärkt oder herausgelöst</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Nothing is chosen to be changed, so noise is removed.</source>
    <translation>Es ist nichts zu ändern gewählt, also wird Rauschen entfernt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Number of pyramids averaged</source>
    <translation>Anzahl gemittelter Pyramiden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Pyramids in random order, each denoised, whose average leaves no traces of triangles. 0 thresholds the details of a single one, which is quick.</source>
    <translation>Pyramiden in zufälliger Reihenfolge, jede entrauscht, deren Mittel keine Spuren von Dreiecken lässt. 0 beschneidet die Details einer einzigen, was schnell geht.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Range of the noise</source>
    <translation>Reichweite des Rauschens</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Remove noise</source>
    <translation>Rauschen entfernen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Replace outliers</source>
    <translation>Ausreißer ersetzen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Root mean square change of elevation</source>
    <translation>Quadratisches Mittel der Höhenänderung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Smallest size kept</source>
    <translation>Kleinste Größe, die bleibt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>So that the kept details remain by themselves, around zero.</source>
    <translation>Damit die behaltenen Details für sich bleiben, um null herum.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Standard deviation of the noise</source>
    <translation>Standardabweichung des Rauschens</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Standard deviation of the noise, in the unit of elevation</source>
    <translation>Standardabweichung des Rauschens, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Stripes along</source>
    <translation>Streifen entlang</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Such as that of a laser scanner. Done too where nothing else is chosen below.</source>
    <translation>Etwa das eines Laserscanners. Geschieht auch, wo unten nichts anderes gewählt ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Take out an offset for each row or column of a DEM, or for each flight line (&lt;i&gt;point_source_id&lt;/i&gt;) of a point cloud.</source>
    <translation>Einen Versatz je Zeile oder Spalte eines DGM entfernen, oder je Flugstreifen (&lt;i&gt;point_source_id&lt;/i&gt;) einer Punktwolke.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>The DEM opens as</source>
    <translation>Das DGM öffnet sich als</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Values that stand out of their ring are replaced before all else.</source>
    <translation>Werte, die aus ihrem Ring herausstechen, werden vor allem anderen ersetzt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>What the details of a level are multiplied by: 0 drops them, 0.5 halves, 2 doubles. Levels that are not listed stay. Level 0 is the coarsest.</source>
    <translation>Womit die Details einer Stufe malgenommen werden: 0 lässt sie weg, 0.5 halbiert, 2 verdoppelt. Nicht genannte Stufen bleiben. Stufe 0 ist die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>denoise,smooth,sharpen,generalise,generalize,band,equaliser,filter,gain,wavelet,pyramid</source>
    <translation>entrauschen,glätten,schärfen,generalisieren,denoise,smooth,sharpen,generalise,generalize,band,equaliser,filter,gain,wavelet,pyramide,pyramid</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Angles, edges and areas of the triangles of every level, as a table</source>
    <translation>Winkel, Kanten und Flächen der Dreiecke jeder Stufe als Tabelle</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Largest angle of the levels, in degrees</source>
    <translation>Größter Winkel der Stufen, in Grad</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Levels</source>
    <translation>Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Measures the triangles of each level in plan: what a solver asks of a mesh before it is taken. A sliver is a triangle with an angle below 10 degrees.</source>
    <translation>Misst die Dreiecke jeder Stufe im Grundriss: was ein Löser von einem Netz verlangt. Ein Splitter ist ein Dreieck mit einem Winkel unter 10 Grad.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Measuring the triangles</source>
    <translation>Messen der Dreiecke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Mesh quality</source>
    <translation>Netzqualität</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Mesh quality by level</source>
    <translation>Netzqualität je Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Numbers separated by commas; 0 is the coarsest. Empty for all.</source>
    <translation>Zahlen, durch Kommas getrennt; 0 ist die gröbste. Leer für alle.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>One row a level. Angles are in degrees, lengths in the unit of the CRS, metres for degrees; &lt;i&gt;low_angle&lt;/i&gt; is what 95 % of the smallest angles are above.</source>
    <translation>Eine Zeile je Stufe. Winkel in Grad, Längen in der Einheit des KBS, bei Grad in Metern; über &lt;i&gt;low_angle&lt;/i&gt; liegen 95 % der kleinsten Winkel.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Shortest edge of the levels</source>
    <translation>Kürzeste Kante der Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Smallest angle of the levels, in degrees</source>
    <translation>Kleinster Winkel der Stufen, in Grad</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>The features could not be written ({}); check the disk and the name.</source>
    <translation>Die Objekte konnten nicht geschrieben werden ({}); prüfen Sie den Datenträger und den Namen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>mesh quality,triangle quality,angle,sliver,edge length,area,statistics,table,tin,pyramid,wavelet</source>
    <translation>Netzqualität,Dreiecksqualität,Winkel,Splitter,Kantenlänge,Fläche,Statistik,Tabelle,TIN,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Along the line, whose corners are points, too, in the unit of the CRS, metres for degrees. Empty for the spacing of the input.</source>
    <translation>Entlang der Linie, deren Ecken auch Punkte sind, in der Einheit des KBS, bei Grad in Metern. Leer für den Abstand der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>CSV (*.csv)</source>
    <translation>CSV (*.csv)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Distance between points</source>
    <translation>Abstand der Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Distance, place and heights of every point, for other programs.</source>
    <translation>Entfernung, Ort und Höhen jedes Punktes, für andere Programme.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Fields: &lt;i&gt;line&lt;/i&gt;, &lt;i&gt;distance&lt;/i&gt;, and &lt;i&gt;z_…&lt;/i&gt; with the height of each level; NULL where it covers nothing.</source>
    <translation>Felder: &lt;i&gt;line&lt;/i&gt;, &lt;i&gt;distance&lt;/i&gt; und &lt;i&gt;z_…&lt;/i&gt; mit der Höhe jeder Stufe; NULL, wo sie nichts bedeckt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>HTML page (*.html)</source>
    <translation>HTML-Seite (*.html)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Heights along lines at several levels of a pyramid, as points, table and plot</source>
    <translation>Höhen entlang von Linien auf mehreren Stufen einer Pyramide, als Punkte, Tabelle und Diagramm</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Largest difference from the finest level</source>
    <translation>Größter Unterschied zur feinsten Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Length of all lines</source>
    <translation>Länge aller Linien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Lines</source>
    <translation>Linien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Lines to walk along, in any CRS; each has charts of its own in the plot.</source>
    <translation>Linien, denen gefolgt wird, in beliebigem KBS; jede hat eigene Diagramme.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>No output is chosen; choose points, a plot, a picture or a table.</source>
    <translation>Keine Ausgabe gewählt; Punkte, Diagramm, Bild oder Tabelle wählen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Number of lines</source>
    <translation>Anzahl der Linien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Numbers separated by commas; 0 is the coarsest. Empty for the input, those with about a quarter and a twentieth of its vertices, and the coarsest.</source>
    <translation>Zahlen, durch Kommas getrennt; 0 ist die gröbste. Leer für die Eingabe, die mit etwa einem Viertel und einem Zwanzigstel ihrer Stützpunkte, und die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Opens in the results viewer and in any browser.</source>
    <translation>Öffnet sich im Ergebnisfenster und in jedem Browser.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Picture of the profile</source>
    <translation>Bild des Profils</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Plot of the profile</source>
    <translation>Diagramm des Profils</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Points of the profile</source>
    <translation>Punkte des Profils</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Profile along lines</source>
    <translation>Profil entlang von Linien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>SVG (*.svg)</source>
    <translation>SVG (*.svg)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Table of the profile</source>
    <translation>Tabelle des Profils</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>The same plot for print layouts and reports.</source>
    <translation>Dasselbe Diagramm für Drucklayouts und Berichte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Walking along the lines</source>
    <translation>Die Linien werden abgeschritten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Walks along lines and reads off the height of several levels of a pyramid. The plot shows them one above the other, and below, how far each is off the finest. The points carry the distance from the start of their line and a height for each level.</source>
    <translation>Schreitet Linien ab und liest die Höhe mehrerer Stufen einer Pyramide ab. Das Diagramm zeigt sie übereinander, und darunter, wie weit jede von der feinsten abweicht. Die Punkte tragen die Entfernung vom Anfang ihrer Linie und eine Höhe je Stufe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>line   level  RMS off the finest  largest</source>
    <translation>Linie  Stufe  RMS zur feinsten    größter</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>profile,section,cross section,transect,elevation profile,plot,chart,level,pyramid,wavelet</source>
    <translation>Profil,Schnitt,Querschnitt,Transekt,Höhenprofil,Diagramm,Stufe,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>{}: there is no line; check the layer and its selection.</source>
    <translation>{}: es gibt keine Linie; den Layer und seine Auswahl prüfen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>All numbers of the report, for other programs.</source>
    <translation>Alle Zahlen des Berichts, für andere Programme.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Figures of the report</source>
    <translation>Zahlen des Berichts</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Levels shown as pictures</source>
    <translation>Als Bilder gezeigte Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Measuring and drawing</source>
    <translation>Messen und Zeichnen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Numbers separated by commas. Empty for those with about a quarter and a twentieth of the vertices, and the coarsest.</source>
    <translation>Zahlen mit Kommas dazwischen. Leer für die mit etwa einem Viertel und einem Zwanzigstel der Punkte, und die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Quality report</source>
    <translation>Qualitätsbericht</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Sizes, errors and triangle shapes of every level of a pyramid, as a web page</source>
    <translation>Größen, Fehler und Dreiecksformen jeder Stufe einer Pyramide, als Webseite</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Writes one HTML page on a pyramid: sizes, errors and triangle quality of every level, curves of the RMSE, histograms of the details, hillshades of the input and of chosen levels, where the error is, and all parameters. The page needs no network.</source>
    <translation>Schreibt eine HTML-Seite über eine Pyramide: Größen, Fehler und Dreiecksqualität jeder Stufe, Kurven des RMSE, Histogramme der Details, Schummerungen der Eingabe und gewählter Stufen, wo der Fehler ist, und alle Parameter. Die Seite braucht kein Netz.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>report,html,rmse,error,accuracy,statistics,triangle quality,pyramid,wavelet</source>
    <translation>bericht,report,html,rmse,fehler,error,genauigkeit,accuracy,statistik,statistics,dreiecksqualität,triangle quality,pyramide,pyramid,wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>'yes' if bit for bit the original</source>
    <translation>'yes', wenn Bit für Bit das Original</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstruct</source>
    <translation>Wiederherstellen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed DEM</source>
    <translation>Wiederhergestelltes DGM</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed TIN</source>
    <translation>Wiederhergestelltes TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed point cloud</source>
    <translation>Wiederhergestellte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Restoring the input</source>
    <translation>Die Eingabe wird wiederhergestellt</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Synthesises the finest level of a pyramid and gives back what it was made from: the DEM bit for bit (same numbers, data type, nodata, grid and CRS), the point cloud with exactly its integers, in its order, or the TIN. A filtered pyramid gives the filtered terrain. Choose the output that fits the pyramid; the others stay empty.</source>
    <translation>Setzt die feinste Stufe einer Pyramide zusammen und gibt zurück, woraus sie gemacht ist: das DGM Bit für Bit (dieselben Zahlen, Datentyp, NoData, Gitter und KBS), die Punktwolke mit genau ihren Ganzzahlen, in ihrer Reihenfolge, oder das TIN. Eine gefilterte Pyramide gibt das gefilterte Gelände. Wählen Sie die Ausgabe, die zur Pyramide passt; die anderen bleiben leer.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>The DEM, point cloud or TIN that a pyramid was made from, bit for bit</source>
    <translation>Das DGM, die Punktwolke oder das TIN, woraus eine Pyramide gemacht ist, Bit für Bit</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>synthesis,inverse,dem,las,laz,tin,wavelet,pyramid,original</source>
    <translation>synthese,umkehrung,wiederherstellen,synthesis,inverse,dgm,dem,las,laz,tin,wavelet,pyramide,pyramid,original</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>0 is the coarsest. Empty for the input itself, and for residual topography the coarsest.</source>
    <translation>0 ist die gröbste. Leer für die Eingabe selbst, und für das Residualrelief die gröbste.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>0 planar, 1 pit, 2 channel, 3 pass, 4 ridge, 5 peak, of the size of the level.</source>
    <translation>0 eben, 1 Senke, 2 Rinne, 3 Sattel, 4 Rücken, 5 Gipfel, von der Größe der Stufe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>&lt;i&gt;windows&lt;/i&gt;: to all that lies within windows two and a half spacings of the level wide, as raster programs do it; &lt;i&gt;surface&lt;/i&gt;: to the surface of the level at its vertices, as &lt;i&gt;Extract level&lt;/i&gt; writes it.</source>
    <translation>&lt;i&gt;windows&lt;/i&gt;: an alles, was in Fenstern von zweieinhalb Abständen der Stufe liegt, wie es Rasterprogramme tun; &lt;i&gt;surface&lt;/i&gt;: an die Oberfläche der Stufe an ihren Punkten, wie &lt;i&gt;Stufe entnehmen&lt;/i&gt; sie schreibt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>A landform has a size: the slope of a hill is not that of its furrows. This gives slope, aspect, curvature and landforms of one level, each as smooth as the level, and how high places are above their surroundings. For levels that are of one size on the ground analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;.</source>
    <translation>Eine Landform hat eine Größe: Die Neigung eines Hügels ist nicht die seiner Furchen. Dies gibt Neigung, Exposition, Krümmung und Landformen einer Stufe, so glatt wie die Stufe, und wie hoch Orte über ihrer Umgebung liegen. Für Stufen, die am Boden von einer Größe sind, mit der Zerlegung &lt;i&gt;random&lt;/i&gt; und der Vorhersage &lt;i&gt;plane&lt;/i&gt; analysieren.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Across the descent; spurs are above 0, hollows below.</source>
    <translation>Quer zum Gefälle; Sporne über 0, Mulden darunter.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Along the descent, in one over the unit of length; convex is above 0.</source>
    <translation>Entlang des Gefälles, in eins durch die Längeneinheit; konvex ist über 0.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Aspect</source>
    <translation>Exposition</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Direction of descent, degrees clockwise from north; nothing on the flat.</source>
    <translation>Richtung des Gefälles, Grad im Uhrzeigersinn von Nord; nichts auf ebenem Grund.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Height above the mean of surroundings of the size of the level.</source>
    <translation>Höhe über dem Mittel einer Umgebung von der Größe der Stufe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Instead of a level: that whose vertices are so far apart, or the nearest, in metres where the CRS states its unit.</source>
    <translation>Statt einer Stufe: die, deren Punkte so weit auseinander liegen, oder die nächste, in Metern, wo das KBS seine Einheit nennt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Landforms</source>
    <translation>Landformen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Mean curvature</source>
    <translation>Mittlere Krümmung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Measuring the shape of the surface</source>
    <translation>Messen der Form der Oberfläche</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>No output is chosen; choose a raster.</source>
    <translation>Keine Ausgabe gewählt; ein Raster wählen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Or distance on the ground</source>
    <translation>Oder Entfernung am Boden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Profile curvature</source>
    <translation>Profilkrümmung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Residual topography</source>
    <translation>Residualrelief</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Ridges and hilltops are above 0, channels and pits below.</source>
    <translation>Rücken und Kuppen über 0, Rinnen und Senken darunter.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Shape fitted to</source>
    <translation>Form angepasst an</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Slope</source>
    <translation>Neigung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Slope, aspect and curvature of level</source>
    <translation>Neigung, Exposition und Krümmung einer Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Steepest, in degrees.</source>
    <translation>Steilste, in Grad.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Tangential curvature</source>
    <translation>Tangentialkrümmung</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>The shape of the terrain at the scale of one level of a pyramid, as rasters</source>
    <translation>Die Form des Geländes im Maßstab einer Stufe einer Pyramide, als Raster</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>slope,aspect,curvature,profile curvature,plan curvature,tangential,geomorphometry,landform,ridge,channel,peak,pit,pass,residual topography,topographic position,terrain analysis,derivatives,scale,level,pyramid,wavelet</source>
    <translation>Neigung,Exposition,Krümmung,Profilkrümmung,Horizontalkrümmung,Tangentialkrümmung,Geomorphometrie,Landform,Rücken,Rinne,Gipfel,Senke,Sattel,Residualrelief,topographische Lage,Geländeanalyse,Ableitungen,Maßstab,Stufe,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Cells with data, or points</source>
    <translation>Zellen mit Daten, oder Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>DEM to the TIN or mesh of a size, or of an accuracy, with a small error</source>
    <translation>DGM zum TIN oder Netz einer Größe, oder einer Genauigkeit, mit kleinem Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Each moves, replaces and reconnects vertices for a smaller error, or for fewer vertices within a tolerance. Empty for as many as pay, 0 for none.</source>
    <translation>Jede verschiebt, ersetzt und verbindet Punkte neu, für kleinere Fehler oder, innerhalb einer Toleranz, für weniger Punkte. Leer: so viele, wie sich lohnen; 0: keine.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Fit the heights to all that is given</source>
    <translation>Die Höhen an alles Gegebene anpassen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Give one of three: the number of vertices, the largest error, or the RMSE.</source>
    <translation>Geben Sie eines von dreien: die Anzahl der Punkte, den größten Fehler oder den RMSE.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Gives the TIN of a number of vertices, or the TIN that is accurate enough, with a small error at all cells of the DEM. Give one of three: the number of vertices, the largest error, or the root mean square error; with none, a twentieth of the cells become vertices.</source>
    <translation>Gibt das TIN mit einer Anzahl von Punkten, oder das TIN, das genau genug ist, mit kleinem Fehler an allen Zellen des DGM. Geben Sie eines von dreien: die Anzahl der Punkte, den größten Fehler oder den mittleren quadratischen Fehler; ohne Angabe wird ein Zwanzigstel der Zellen zu Punkten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Height and all, also where the RMSE counts: heights are not fitted.</source>
    <translation>Samt ihrer Höhe, auch wo der RMSE zählt: Höhen werden nicht ausgeglichen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>In the unit of the CRS; empty for the grid of the DEM, or the spacing of points.</source>
    <translation>In der Einheit des KBS; leer für das Gitter des DGM oder den Abstand der Punkte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Least squares: the smallest RMSE that these triangles can have. Without it the TIN is the pyramid's coarsest level as it is; where the largest error is kept small, heights are those of the input.</source>
    <translation>Kleinste Quadrate: der kleinste RMSE, den diese Dreiecke haben können. Ohne das ist das TIN die gröbste Stufe der Pyramide, wie sie ist; wo der größte Fehler klein bleiben soll, sind die Höhen die der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Measuring the errors</source>
    <translation>Messen der Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Mesh of the TIN</source>
    <translation>Netz des TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>No cell or point is farther above or below the TIN, in the unit of elevation.</source>
    <translation>Keine Zelle und kein Punkt liegt weiter über oder unter dem TIN, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>No output is chosen; choose a TIN, a raster, a mesh or a pyramid.</source>
    <translation>Keine Ausgabe ist gewählt; wählen Sie ein TIN, ein Raster, ein Netz oder eine Pyramide.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Number of levels</source>
    <translation>Anzahl der Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>RMSE</source>
    <translation>RMSE</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Raster of the TIN</source>
    <translation>Raster des TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Refining the TIN</source>
    <translation>Das TIN wird verfeinert</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Root mean square error over all cells or points, in the unit of elevation.</source>
    <translation>Mittlerer quadratischer Fehler über alle Zellen oder Punkte, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplified TIN</source>
    <translation>Vereinfachtes TIN</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplify DEM to TIN</source>
    <translation>DGM zum TIN vereinfachen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplifying (the first run also compiles, up to half a minute)</source>
    <translation>Vereinfachen (der erste Lauf übersetzt auch, bis zu einer halben Minute)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The TIN evaluated at the cell centres.</source>
    <translation>Das TIN an den Zellmitten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The TIN has exactly this many, if it can get there.</source>
    <translation>Das TIN hat genau so viele, wenn es dahin kommt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The reversible pyramid whose coarsest level the TIN was made from.</source>
    <translation>Die umkehrbare Pyramide, aus deren gröbster Stufe das TIN entstand.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Vertices are points of the input</source>
    <translation>Eckpunkte sind Punkte der Eingabe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>at all cells or points</source>
    <translation>an allen Zellen oder Punkten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>simplify,thin,generalise,generalize,decimate,reduce,tin,tin from dem,mesh,mesh from dem,dem to mesh,raster to tin,2dm,dem,level of detail,lod</source>
    <translation>vereinfachen,ausdünnen,generalisieren,tin aus dgm,netz aus dgm,simplify,thin,generalise,generalize,decimate,reduce,tin,tin from dem,mesh,mesh from dem,dem to mesh,raster to tin,2dm,dgm,dem,level of detail,lod</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Gives the TIN of a number of vertices, or the TIN that is accurate enough, of the ground points of a LAS, LAZ or COPC file, and the points of the file that carry it: few on plains, many on banks. Give one of three: the number of vertices, the largest error, or the root mean square error; with none, a twentieth of the points stay.</source>
    <translation>Gibt das TIN mit einer Anzahl von Punkten, oder das TIN, das genau genug ist, aus den Bodenpunkten einer LAS-, LAZ- oder COPC-Datei, und die Punkte der Datei, die es tragen: wenige in Ebenen, viele an Böschungen. Geben Sie eines von dreien: die Anzahl der Punkte, den größten Fehler oder den mittleren quadratischen Fehler; ohne Angabe bleibt ein Zwanzigstel der Punkte.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to the TIN of a size or an accuracy, and fewer points</source>
    <translation>LAS-, LAZ- oder COPC-Datei zum TIN einer Größe oder Genauigkeit, und zu weniger Punkten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Largest error of the Delaunay TIN of the thinned points</source>
    <translation>Größter Fehler des Delaunay-TIN der ausgedünnten Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Measuring the Delaunay TIN of the points that stay</source>
    <translation>Messen des Delaunay-TIN der Punkte, die bleiben</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Points of the thinned point cloud</source>
    <translation>Punkte der ausgedünnten Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>RMSE of the Delaunay TIN of the thinned points</source>
    <translation>RMSE des Delaunay-TIN der ausgedünnten Punkte</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Simplify point cloud to TIN</source>
    <translation>Punktwolke zum TIN vereinfachen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>The points that are the vertices of the TIN, exactly as they were, with all their dimensions. Triangulated again they give other triangles: where a largest error is asked for, points are added until those keep it too. LAZ needs the Python package lazrs.</source>
    <translation>Die Punkte, die im TIN bleiben, genau wie sie waren, mit allen Dimensionen. Neu trianguliert geben sie andere Dreiecke: Wo ein größter Fehler verlangt ist, kommen Punkte dazu, bis auch diese ihn einhalten. LAZ braucht das Python-Paket lazrs.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Thinned point cloud</source>
    <translation>Ausgedünnte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>simplify,thin,thin point cloud,generalise,generalize,decimate,reduce,las,laz,lidar,point cloud,ground,tin,tin from point cloud,mesh,2dm,dtm,level of detail,lod</source>
    <translation>vereinfachen,ausdünnen,generalisieren,boden,punktwolke,simplify,thin,thin point cloud,generalise,generalize,decimate,reduce,las,laz,lidar,point cloud,ground,tin,tin from point cloud,mesh,2dm,dgm,dtm,level of detail,lod</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>the thinned point cloud</source>
    <translation>die ausgedünnte Punktwolke</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to those of its points that carry its surface best</source>
    <translation>LAS-, LAZ- oder COPC-Datei zu denen ihrer Punkte, die ihre Fläche am besten tragen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>Thin point cloud</source>
    <translation>Punktwolke ausdünnen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>Writes the points of a LAS, LAZ or COPC file that carry its surface best, exactly as they were, with all their dimensions: few on plains, many on banks. The ground is taken where the file has it marked. Give one of three: the number of points, the largest error, or the root mean square error of the surface through them; with none, a twentieth stays.</source>
    <translation>Schreibt die Punkte einer LAS-, LAZ- oder COPC-Datei, die ihre Fläche am besten tragen, genau wie sie waren, mit allen Dimensionen: wenige in Ebenen, viele an Böschungen. Der Boden wird genommen, wo die Datei ihn nennt. Geben Sie eines von dreien: die Anzahl der Punkte, den größten oder den mittleren quadratischen Fehler der Fläche durch sie; ohne Angabe bleibt ein Zwanzigstel.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>thin,thinning,decimate,subsample,reduce,simplify,generalise,generalize,las,laz,lidar,point cloud,ground,key points,model key points</source>
    <translation>ausdünnen,vereinfachen,generalisieren,thin,thinning,decimate,subsample,reduce,simplify,generalise,generalize,las,laz,lidar,punktwolke,point cloud,boden,ground,key points,model key points</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Add the index to the map</source>
    <translation>Den Index der Karte hinzufügen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Cancelled; the tiles that were made stay, and the same parameters go on from there.</source>
    <translation>Abgebrochen; fertige Kacheln bleiben, und mit denselben Parametern geht es dort weiter.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Folder of tiles</source>
    <translation>Ordner der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Making the tiles</source>
    <translation>Machen der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Most levels of a tile</source>
    <translation>Die meisten Stufen einer Kachel</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Number of levels of the whole</source>
    <translation>Anzahl der Stufen des Ganzen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Number of tiles</source>
    <translation>Anzahl der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Of DEMs in cells, 1024 if empty; a tile of so many needs some 1.7 GB of memory. Of point clouds in the unit of x and y; if empty, such that a tile has about a million points, which need about 1 GB.</source>
    <translation>Von DGM in Zellen, leer 1024; eine Kachel von so vielen braucht rund 1,7 GB Speicher. Von Punktwolken in der Einheit von x und y; leer so, dass eine Kachel etwa eine Million Punkte hat, die rund 1 GB brauchen.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Of each tile, and of each group of four. Empty for 64.</source>
    <translation>Jeder Kachel, und jeder Gruppe von vieren. Leer für 64.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Opens the footprints of the tiles, with their sizes and errors.</source>
    <translation>Öffnet die Umrisse der Kacheln, mit ihren Größen und Fehlern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Reading the headers</source>
    <translation>Lesen der Köpfe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Set aside: stage {}, row {}, column {}: {}</source>
    <translation>Beiseitegelegt: Stadium {}, Zeile {}, Spalte {}: {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Side of a tile</source>
    <translation>Seite einer Kachel</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Terrain beyond memory to a tiled pyramid: a file for each tile, and an index</source>
    <translation>Gelände, das nicht in den Speicher passt, wird eine gekachelte Pyramide: eine Datei je Kachel, und ein Index</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tile large DEM or point clouds</source>
    <translation>Großes DGM oder Punktwolken kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tile {} of {}: stage {}, row {}, column {}</source>
    <translation>Kachel {} von {}: Stadium {}, Zeile {}, Spalte {}</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups made in this run</source>
    <translation>Kacheln und Gruppen, die in diesem Lauf gemacht wurden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups that were set aside</source>
    <translation>Kacheln und Gruppen, die beiseitegelegt wurden</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups that were there before</source>
    <translation>Kacheln und Gruppen, die schon da waren</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Turns a DEM or point clouds that need not fit into memory into a pyramid of tiles. Each tile is analysed by itself, its border locked; then two by two tiles become one, up to a single one for the whole. At any level the tiles together are one TIN, without cracks. &lt;i&gt;Extract from tiles&lt;/i&gt; gives any region at any level. A run that was cancelled, or stopped in any other way, goes on where it was when it is started again with the same parameters.</source>
    <translation>Macht aus einem DGM oder Punktwolken, die nicht in den Speicher passen müssen, eine Pyramide aus Kacheln. Jede Kachel wird für sich analysiert, ihr Rand festgehalten; dann werden je zwei mal zwei Kacheln eine, bis zu einer einzigen für das Ganze. In jeder Stufe sind die Kacheln zusammen ein TIN ohne Risse. &lt;i&gt;Aus Kacheln entnehmen&lt;/i&gt; gibt jedes Gebiet in jeder Stufe. Ein Lauf, der abgebrochen wurde oder sonst stehen blieb, geht dort weiter, wo er war, wenn er mit denselben Parametern wieder gestartet wird.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>With &lt;i&gt;index.gpkg&lt;/i&gt; and the tiles. Of an earlier run with the same parameters what is whole is kept; tiles of another input are replaced.</source>
    <translation>Mit &lt;i&gt;index.gpkg&lt;/i&gt; und den Kacheln. Von einem früheren Lauf mit denselben Parametern bleibt, was heil ist; Kacheln einer anderen Eingabe werden ersetzt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>tile,tiles,large,big,huge,out of core,mosaic,dem,las,laz,copc,ept,lidar,index,pyramid,wavelet</source>
    <translation>Kachel,Kacheln,groß,riesig,Speicher,Mosaik,DGM,LAS,LAZ,COPC,EPT,Lidar,Index,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>{} tiles, {} with groups, in {} stages</source>
    <translation>{} Kacheln, {} mit Gruppen, in {} Stadien</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source> zoom   tiles  vertices  largest error (m)</source>
    <translation> Zoom Kacheln  Punkte  größter Fehler (m)</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>0 is the coarsest. Empty for the input itself.</source>
    <translation>0 ist die gröbste. Leer für die Eingabe selbst.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Empty for the one whose tiles have some 128 points along each side.</source>
    <translation>Leer für die, deren Kacheln rund 128 Punkte je Seite haben.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Finest zoom</source>
    <translation>Feinste Zoomstufe</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>For light and shade.</source>
    <translation>Für Licht und Schatten.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Height beyond the data</source>
    <translation>Höhe außerhalb der Daten</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>In metres.</source>
    <translation>In Metern.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Largest error of the finest zoom, in metres</source>
    <translation>Größter Fehler der feinsten Zoomstufe, in Metern</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Number of zooms</source>
    <translation>Anzahl der Zoomstufen</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Of the finest zoom, in metres; twice that for the next, and so on. Empty for a tenth of the spacing of the points.</source>
    <translation>Der feinsten Zoomstufe, in Metern; das Doppelte für die nächste, und so weiter. Leer für ein Zehntel des Punktabstands.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Quantized-mesh tiles of all zooms for globes such as CesiumJS, and for QGIS</source>
    <translation>Quantized-Mesh-Kacheln aller Zoomstufen für Globen wie CesiumJS, und für QGIS</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Terrain for the web</source>
    <translation>Gelände fürs Web</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>With &lt;i&gt;layer.json&lt;/i&gt; and the tiles. An earlier tile set there is replaced.</source>
    <translation>Mit &lt;i&gt;layer.json&lt;/i&gt; und den Kacheln. Ein früherer Kachelsatz dort wird ersetzt.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Write normals</source>
    <translation>Normalen schreiben</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Writes the terrain as tiles of triangles for all zooms, without cracks between them, each zoom half as far off as the one before. A web server that gives the folder to a globe is all that it takes; QGIS reads it as a quantized-mesh layer.</source>
    <translation>Schreibt das Gelände als Kacheln aus Dreiecken für alle Zoomstufen, ohne Risse dazwischen, jede halb so weit daneben wie die vorige. Ein Webserver, der den Ordner einem Globus gibt, genügt; QGIS liest ihn als Quantized-Mesh-Layer.</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Writing the tiles</source>
    <translation>Schreiben der Kacheln</translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>quantized mesh,cesium,globe,tiles,terrain,3d,web,layer.json,level,pyramid,wavelet</source>
    <translation>Quantized Mesh,Cesium,Globus,Kacheln,Gelände,3D,Web,layer.json,Stufe,Pyramide,Wavelet</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Also returned</source>
    <translation>Außerdem zurückgegeben</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Analysis</source>
    <translation>Analyse</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Cancelled; nothing was written.</source>
    <translation>Abgebrochen; nichts wurde geschrieben.</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Details</source>
    <translation>Details</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Parameters</source>
    <translation>Parameter</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Quality</source>
    <translation>Qualität</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Read off</source>
    <translation>Ablesen</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Reconstruction</source>
    <translation>Wiederherstellung</translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>There is not enough memory for this input (some 700 bytes a vertex are needed). Cut it, or take a coarser one.</source>
    <translation>Der Speicher reicht für diese Eingabe nicht (etwa 700 Byte je Punkt werden gebraucht). Schneiden Sie sie, oder nehmen Sie eine gröbere.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Attribute</source>
    <translation>Attribut</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>By default the unit that the CRS states; where it states none, metres for a geographic CRS and the unit of x and y for any other. Results keep the input's unit.</source>
    <translation>Üblicherweise die Einheit, die das KBS nennt; wo es keine nennt, Meter bei geographischem KBS und sonst die Einheit von x und y. Ergebnisse behalten die Einheit der Eingabe.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>By what the &lt;i&gt;quadric&lt;/i&gt; partition ranks. By default as the paper says.</source>
    <translation>Wonach die Zerlegung &lt;i&gt;quadric&lt;/i&gt; ordnet. Ohne Angabe wie im Aufsatz.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Cost of the paper's partition</source>
    <translation>Kosten der Zerlegung des Aufsatzes</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Error kept small</source>
    <translation>Klein gehaltener Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How a removed vertex is estimated from its neighbours; what is left over is its detail. By default &lt;i&gt;barycentric&lt;/i&gt; with the &lt;i&gt;surface&lt;/i&gt; partition, else &lt;i&gt;geometric&lt;/i&gt;.</source>
    <translation>Wie ein entfernter Punkt aus seinen Nachbarn geschätzt wird; was übrig bleibt, ist sein Detail. Üblicherweise &lt;i&gt;barycentric&lt;/i&gt; mit der Zerlegung &lt;i&gt;surface&lt;/i&gt;, sonst &lt;i&gt;geometric&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How details are passed on to the vertices that stay.</source>
    <translation>Wie Details an die Punkte weitergegeben werden, die bleiben.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How far the outline, holes included, may move in plan, in the unit of x and y (metres for a geographic CRS), with the &lt;i&gt;surface&lt;/i&gt; partition. Empty for 0: vertices of the outline are removed only where it runs straight, which limits how coarse a level can become. The log says how much the area changes.</source>
    <translation>Wie weit der Rand, Löcher eingeschlossen, sich in der Ebene bewegen darf, in der Einheit von x und y (bei geographischem KBS in Metern), mit der Zerlegung &lt;i&gt;surface&lt;/i&gt;. Leer für 0: Punkte des Rands werden nur entfernt, wo er gerade läuft, was begrenzt, wie grob eine Stufe werden kann. Das Protokoll sagt, wie sehr die Fläche sich ändert.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How many steps of analysis at most (the paper's L). Each removes up to a quarter of the vertices. Fewer come out where nothing more can go. Empty for as many as a rule below takes; without one for 24, not counting those that thin flat parts alone, or 12 with another partition than &lt;i&gt;surface&lt;/i&gt;.</source>
    <translation>Wie viele Schritte der Analyse höchstens (das L des Artikels). Jeder entfernt bis zu einem Viertel der Punkte. Es werden weniger, wo nichts mehr gehen kann. Leer für so viele, wie eine Regel unten braucht; ohne eine für 24, ohne die, die nur flache Teile ausdünnen, oder 12 mit einer anderen Zerlegung als &lt;i&gt;surface&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How much an attribute counts, compared with the elevation, in which vertices are removed and how they are predicted; each is scaled by its range first. 1 where it is not listed, 0 for one that is only carried along.</source>
    <translation>Wie viel ein Attribut, verglichen mit der Höhe, dabei zählt, welche Punkte entfernt und wie sie vorhergesagt werden; jedes wird zuerst auf seine Spanne bezogen. 1, wo es nicht genannt ist, 0 für eines, das nur mitgeführt wird.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Largest share removed at a level</source>
    <translation>Größter Anteil, der in einer Stufe entfernt wird</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Lifted coordinates</source>
    <translation>Transformierte Koordinaten</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Most levels</source>
    <translation>Höchste Zahl der Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>No input point is farther above or below the coarsest level, in the unit of elevation.</source>
    <translation>Kein Punkt der Eingabe liegt weiter über oder unter der gröbsten Stufe, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Partition</source>
    <translation>Zerlegung</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Prediction filter</source>
    <translation>Vorhersagefilter</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Quadrics of the paper's partition</source>
    <translation>Quadriken der Zerlegung des Aufsatzes</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this RMSE</source>
    <translation>Aufhören bei diesem RMSE</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this largest error</source>
    <translation>Aufhören bei diesem größten Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this number of vertices</source>
    <translation>Aufhören bei dieser Anzahl von Punkten</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The &lt;i&gt;surface&lt;/i&gt; partition removes at most this share of a level's vertices, between 0 and 1; empty for the default. A smaller share makes more levels and takes longer, and the errors are a little smaller.</source>
    <translation>Die Zerlegung &lt;i&gt;surface&lt;/i&gt; entfernt höchstens diesen Anteil der Punkte einer Stufe, zwischen 0 und 1; leer für den üblichen. Ein kleinerer Anteil macht mehr Stufen und dauert länger, und die Fehler sind etwas kleiner.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The coarsest level has exactly this many vertices, if it can get there; the log says why if it cannot.</source>
    <translation>Die gröbste Stufe hat genau so viele Punkte, wenn sie dahin kommt; das Protokoll sagt, warum, wenn nicht.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The same for the root mean square over all input points, in the unit of elevation.</source>
    <translation>Dasselbe für das quadratische Mittel über alle Punkte der Eingabe, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>There is no attribute {} to be weighted; {}.</source>
    <translation>Es gibt kein Attribut {}, das gewichtet werden könnte; {}.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Tolerance of the outline</source>
    <translation>Toleranz des Rands</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Unit of elevation</source>
    <translation>Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Update filter</source>
    <translation>Aktualisierungsfilter</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight</source>
    <translation>Gewicht</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight of bending energy</source>
    <translation>Gewicht der Biegeenergie</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight of curvature in the cost of the &lt;i&gt;quadric&lt;/i&gt; partition; no unit.</source>
    <translation>Gewicht der Krümmung in den Kosten der Zerlegung &lt;i&gt;quadric&lt;/i&gt;; ohne Einheit.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weights are pairs of an attribute and a number of 0 or more, such as intensity and 0.5.</source>
    <translation>Gewichte sind Paare aus einem Attribut und einer Zahl ab 0, etwa intensity und 0.5.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weights of attributes</source>
    <translation>Gewichte der Attribute</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What becomes of the quadrics from level to level, with the &lt;i&gt;quadric&lt;/i&gt; partition. By default as the paper says.</source>
    <translation>Was bei der Zerlegung &lt;i&gt;quadric&lt;/i&gt; von Stufe zu Stufe aus den Quadriken wird. Ohne Angabe wie im Aufsatz.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What the &lt;i&gt;surface&lt;/i&gt; partition keeps small. By default &lt;i&gt;rms&lt;/i&gt;, or &lt;i&gt;max&lt;/i&gt; where the largest error is the stop rule.</source>
    <translation>Was die Zerlegung &lt;i&gt;surface&lt;/i&gt; klein hält. Üblicherweise &lt;i&gt;rms&lt;/i&gt;, oder &lt;i&gt;max&lt;/i&gt;, wo der größte Fehler die Abbruchregel ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What the wavelets transform. By default &lt;i&gt;z&lt;/i&gt;.</source>
    <translation>Was die Wavelets transformieren. Üblicherweise &lt;i&gt;z&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Which vertices are removed at a level (the paper's odd vertices). By default &lt;i&gt;surface&lt;/i&gt;, or &lt;i&gt;quadric&lt;/i&gt; with another filter than &lt;i&gt;barycentric&lt;/i&gt;.</source>
    <translation>Welche Punkte in einer Stufe entfernt werden (die ungeraden des Artikels). Üblicherweise &lt;i&gt;surface&lt;/i&gt;, oder &lt;i&gt;quadric&lt;/i&gt; mit einem anderen Filter als &lt;i&gt;barycentric&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>choose the attributes first</source>
    <translation>wählen Sie zuerst die Attribute</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>those analysed are: {}</source>
    <translation>analysiert werden: {}</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>The suffix chooses the format:</source>
    <translation>Die Endung wählt das Format:</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>coordinates count from an origin that the file names</source>
    <translation>Koordinaten zählen von einem Ursprung, den die Datei nennt</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>keeps attributes</source>
    <translation>behält Attribute</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>needs the Python package {}</source>
    <translation>braucht das Python-Paket {}</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Add the pyramid to the map</source>
    <translation>Pyramide zur Karte hinzufügen</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Input points that the coarsest surface does not cover</source>
    <translation>Punkte der Eingabe, die die gröbste Fläche nicht bedeckt</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Largest error of the coarsest surface, in the unit of elevation</source>
    <translation>Größter Fehler der gröbsten Fläche, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Opens the layers in the pyramid file, with their styles, when it is written.</source>
    <translation>Öffnet die Layer der Pyramidendatei mit ihren Stilen, sobald sie geschrieben ist.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>RMSE of the coarsest surface at all input points, in the unit of elevation</source>
    <translation>RMSE der gröbsten Fläche an allen Punkten der Eingabe, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>RMSE of the coefficients at the coarsest level (no unit)</source>
    <translation>RMSE der Koeffizienten in der gröbsten Stufe (ohne Einheit)</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>There is no level {}; the levels of this pyramid are 0 (coarsest) to {}.</source>
    <translation>Es gibt keine Stufe {}; die Stufen dieser Pyramide sind 0 (die gröbste) bis {}.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Triangles of the coarsest level</source>
    <translation>Dreiecke der gröbsten Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Triangles of the input</source>
    <translation>Dreiecke der Eingabe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Vertices of the coarsest level</source>
    <translation>Punkte der gröbsten Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Vertices of the input</source>
    <translation>Punkte der Eingabe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Writing the pyramid</source>
    <translation>Schreiben der Pyramide</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>level   vertices</source>
    <translation>Stufe  Stützpunkte</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>level   vertices  triangles  RMSE of surface  largest error</source>
    <translation>Stufe     Punkte   Dreiecke  RMSE der Fläche  größter Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>{}: its CRS is {}, that of the pyramid is {}; reproject it.</source>
    <translation>{}: sein KBS ist {}, das der Pyramide ist {}; umprojizieren.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>{}: of this layer and the terrain only one has a CRS, so their coordinates are taken to be alike (assign the CRS that is missing)</source>
    <translation>{}: Von diesem Layer und dem Gelände hat nur eines ein KBS, deshalb gelten ihre Koordinaten als gleichartig (weisen Sie das fehlende KBS zu)</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>For a pyramid of a DEM.</source>
    <translation>Für eine Pyramide aus einem DGM.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>For a pyramid of a point cloud file. Needs the Python package laspy.</source>
    <translation>Für eine Pyramide aus einer Punktwolkendatei. Braucht das Python-Paket laspy.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>LAZ (*.laz);;LAS (*.las)</source>
    <translation>LAZ (*.laz);;LAS (*.las)</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>The triangles of the finest level, for a pyramid of any kind.</source>
    <translation>Die Dreiecke der feinsten Stufe, für eine Pyramide jeder Art.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a DEM; choose where the DEM goes.</source>
    <translation>Diese Pyramide ist aus einem DGM gemacht; wählen Sie, wohin das DGM geht.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a TIN; choose where the TIN goes.</source>
    <translation>Diese Pyramide ist aus einem TIN gemacht; wählen Sie, wohin das TIN geht.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a point cloud; choose a file for the point cloud, or take the TIN.</source>
    <translation>Diese Pyramide ist aus einer Punktwolke gemacht; wählen Sie eine Datei für die Punktwolke, oder nehmen Sie das TIN.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Cell size of the raster</source>
    <translation>Zellgröße des Rasters</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made from, and for points their mean spacing.</source>
    <translation>In der Einheit des KBS. Leer für das Gitter des DGM, aus dem die Pyramide gemacht ist, und bei Punkten für ihren mittleren Abstand.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Input points that the surface does not cover</source>
    <translation>Punkte der Eingabe, die die Fläche nicht bedeckt</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Largest error {}, in the unit of elevation</source>
    <translation>Größter Fehler {}, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>RMSE {}, in the unit of elevation</source>
    <translation>RMSE {}, in der Einheit der Höhe</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Field with the largest error</source>
    <translation>Feld mit dem größten Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Give a raster of largest errors, or one largest error, not both.</source>
    <translation>Ein Raster größter Fehler oder einen größten Fehler angeben, nicht beides.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Give zones and the field with their largest error, or neither.</source>
    <translation>Zonen und das Feld mit ihrem größten Fehler angeben, oder keines von beiden.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Instead of one number: the largest error by place, in the unit of elevation.</source>
    <translation>Statt einer Zahl: der größte Fehler je Ort, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>No point of the terrain is inside a zone; check that the layers overlap.</source>
    <translation>Kein Punkt des Geländes liegt in einer Zone; prüfen, ob die Layer sich überlappen.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Of the zones, in the unit of elevation.</source>
    <translation>Der Zonen, in der Einheit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Polygons with a largest error of their own; where several overlap, the least counts. &lt;i&gt;Largest error&lt;/i&gt; holds outside.</source>
    <translation>Polygone mit einem eigenen größten Fehler; wo mehrere sich überlappen, zählt der kleinste. Außerhalb gilt &lt;i&gt;Größter Fehler&lt;/i&gt;.</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Raster of largest errors</source>
    <translation>Raster größter Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Within {:g}: {} of {} points are vertices; RMSE {:.4g}, largest error {:.4g}</source>
    <translation>Bis {:g}: {} von {} Punkten sind Stützpunkte; RMSE {:.4g}, größter Fehler {:.4g}</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Zones of other accuracy</source>
    <translation>Zonen anderer Genauigkeit</translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>{}: no point of the terrain is in a cell of it; check that the layers overlap.</source>
    <translation>{}: kein Punkt des Geländes liegt in einer seiner Zellen; prüfen, ob die Layer sich überlappen.</translation>
  </message>
  <message>
    <location filename="../../plugin/provider.py"/>
    <source>Terrain Wavelets: reversible multiresolution TINs</source>
    <translation>Terrain Wavelets: umkehrbare TINs in vielen Auflösungen</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/constraints.py"/>
    <source>{}: there is no breakline here; the TIN is made without.</source>
    <translation>{}: Hier ist keine Bruchkante; das TIN wird ohne gemacht.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/constraints.py"/>
    <source>{}: there is no polygon to clip by; check the layer, its filter and selection.</source>
    <translation>{}: Hier ist kein Polygon zum Schneiden; prüfen Sie den Layer, seinen Filter und die Auswahl.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/geopackage.py"/>
    <source>{}: layer {} cannot be written ({}); check the disk and the name.</source>
    <translation>{}: Layer {} kann nicht geschrieben werden ({}); prüfen Sie den Datenträger und den Namen.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/laz_unpacker.py"/>
    <source>{}: QGIS's pdal_wrench cannot unpack this file ({}); get it again.</source>
    <translation>{}: Das Programm pdal_wrench von QGIS kann diese Datei nicht entpacken ({}); holen Sie sie noch einmal.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: band {} holds values of type {}; elevations must be real numbers.</source>
    <translation>{}: Kanal {} enthält Werte des Typs {}; Höhen müssen reelle Zahlen sein.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: the raster cannot be read ({}); the file is damaged, get it again.</source>
    <translation>{}: Das Raster kann nicht gelesen werden ({}); die Datei ist beschädigt, holen Sie sie noch einmal.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: there is no band {}; the raster has {}.</source>
    <translation>{}: Es gibt keinen Kanal {}; das Raster hat {}.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_writer.py"/>
    <source>{}: GDAL could not write this raster ({}); check the disk and the name.</source>
    <translation>{}: GDAL konnte dieses Raster nicht schreiben ({}); prüfen Sie den Datenträger und den Namen.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_writer.py"/>
    <source>{}: no raster of {} can be written under this name; use one ending in .tif.</source>
    <translation>{}: Unter diesem Namen kann kein Raster aus {} geschrieben werden; nehmen Sie einen, der auf .tif endet.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/training.py"/>
    <source>Feature {}: field {} holds {}; classes are whole numbers from 0 to 254.</source>
    <translation>Objekt {}: Feld {} enthält {}; Klassen sind ganze Zahlen von 0 bis 254.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>Feature {}: field {} holds {}, which is no number; fill or filter it.</source>
    <translation>Objekt {}: Feld {} enthält {}, was keine Zahl ist; füllen oder filtern Sie es.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: feature {} is no triangle; triangulate the layer first, or give a point layer.</source>
    <translation>{}: Objekt {} ist kein Dreieck; triangulieren Sie den Layer zuerst, oder geben Sie einen Punktlayer.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: the points have no Z; choose the field with the elevation.</source>
    <translation>{}: Die Punkte haben kein Z; wählen Sie das Feld mit der Höhe.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: the triangles have no Z, so they hold no elevations; give a layer whose geometries have Z.</source>
    <translation>{}: Die Dreiecke haben kein Z, also keine Höhen; geben Sie einen Layer an, dessen Geometrien Z haben.</translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: what cannot be brought into the CRS of the terrain is left out (features: {}); check the CRS of the layer</source>
    <translation>{}: Was sich nicht in das KBS des Geländes bringen lässt, bleibt weg (Objekte: {}); prüfen Sie das KBS des Layers</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>LAS files; the zip of the plugin brings a copy</source>
    <translation>LAS-Dateien; das Zip der Erweiterung bringt eine Kopie mit</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>LAZ and COPC files</source>
    <translation>LAZ- und COPC-Dateien</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>Terrain Wavelets needs Python {} or later, and this QGIS runs Python {}; install a newer QGIS.</source>
    <translation>Terrain Wavelets braucht Python {} oder neuer, und dieses QGIS hat Python {}; installieren Sie ein neueres QGIS.</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>The Python package numba is missing: the work takes two to seven times as long, to refine a TIN within a tolerance 6 to 17 times, with the same result. Install it {} and start QGIS again.</source>
    <translation>Das Python-Paket numba fehlt: Die Arbeit dauert zwei- bis siebenmal so lang, das Verfeinern eines TIN innerhalb einer Toleranz 6- bis 17-mal, mit demselben Ergebnis. Installieren Sie es {} und starten Sie QGIS neu.</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>classes learned in Cluster details</source>
    <translation>Klassen lernen in „Details gruppieren“</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in Terminal</source>
    <translation>im Terminal</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in a terminal</source>
    <translation>in einem Terminal</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in the OSGeo4W Shell (Start menu, QGIS)</source>
    <translation>in der OSGeo4W-Shell (Startmenü, QGIS)</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as DXF</source>
    <translation>Netze als DXF</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as GLB</source>
    <translation>Netze als GLB</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as SELAFIN, for TELEMAC</source>
    <translation>Netze als SELAFIN, für TELEMAC</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes for solvers: bounds of angles and edges</source>
    <translation>Netze für Löser: Schranken für Winkel und Kanten</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>missing Python package: {names}. Install it {remedy} and start QGIS again.</source>
    <translation>Fehlendes Python-Paket: {names}. Installieren Sie es {remedy} und starten Sie QGIS neu.</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>points and breaklines are triangulated four times as fast</source>
    <translation>Punkte und Bruchkanten werden viermal so schnell trianguliert</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>two to seven times as fast, within a tolerance up to 17 times</source>
    <translation>zwei- bis siebenmal so schnell, innerhalb einer Toleranz bis zu 17-mal</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>LAS, LAZ and COPC (*.las *.laz *.LAS *.LAZ)</source>
    <translation>LAS, LAZ und COPC (*.las *.laz *.LAS *.LAZ)</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>Select a file</source>
    <translation>Datei wählen</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>a point cloud layer of the project, or a file</source>
    <translation>ein Punktwolken-Layer des Projekts, oder eine Datei</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>a pyramid of this project or session, or a file</source>
    <translation>eine Pyramide dieses Projekts oder dieser Sitzung, oder eine Datei</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>largest error</source>
    <translation>größter Fehler</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>level</source>
    <translation>Stufe</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>not measured</source>
    <translation>nicht gemessen</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>vertices</source>
    <translation>Stützpunkte</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/known_pyramids.py"/>
    <source>{} (temporary)</source>
    <translation>{} (temporär)</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/known_pyramids.py"/>
    <source>{}: {}, {} levels</source>
    <translation>{}: {}, {} Stufen</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>channel</source>
    <translation>Rinne</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>level {}</source>
    <translation>Stufe {}</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>pass</source>
    <translation>Sattel</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>peak</source>
    <translation>Gipfel</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>pit</source>
    <translation>Senke</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>planar</source>
    <translation>eben</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>ridge</source>
    <translation>Rücken</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/options_page.py"/>
    <source>installed</source>
    <translation>installiert</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/options_page.py"/>
    <source>{}: {}; missing, install it {}</source>
    <translation>{}: {}; fehlt, zu installieren {}</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>a layer reprojected before</source>
    <translation>einen vorher umprojizierten Layer</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>the layer's additional nodata value</source>
    <translation>der zusätzliche NoData-Wert des Layers</translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>the layer's properties</source>
    <translation>die Eigenschaften des Layers</translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>in random order, for pyramids that are averaged</source>
    <translation>in zufälliger Reihenfolge, für Pyramiden, die gemittelt werden</translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>in the order of their index, regardless of shape</source>
    <translation>in der Reihenfolge ihrer Nummer, ungeachtet der Form</translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>those of least cost by generalised quadrics and bending energy</source>
    <translation>die mit den geringsten Kosten nach verallgemeinerten Quadriken und Biegeenergie</translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>those that raise the vertical errors at all input points least</source>
    <translation>die, die die Höhenfehler an allen Punkten der Eingabe am wenigsten erhöhen</translation>
  </message>
  <message>
    <location filename="../../NORMS"/>
    <source>the largest vertical error</source>
    <translation>der größte Höhenfehler</translation>
  </message>
  <message>
    <location filename="../../NORMS"/>
    <source>the mean square of the vertical errors</source>
    <translation>das mittlere Quadrat der Höhenfehler</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>cotangents of the angles opposite each edge, not below 0</source>
    <translation>Kotangenten der Winkel gegenüber jeder Kante, nicht unter 0</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>from the coarse triangle that now covers the vertex</source>
    <translation>aus dem groben Dreieck, das den Punkt nun bedeckt</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>from the plane fitted to the neighbours; slopes have no details</source>
    <translation>aus der an die Nachbarn angepassten Ebene; Hänge haben keine Details</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>one over the distance in coordinates and attributes</source>
    <translation>eins durch den Abstand in Koordinaten und Attributen</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the mean of the neighbours</source>
    <translation>das Mittel der Nachbarn</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the non-negative weights that leave the smallest detail</source>
    <translation>die nichtnegativen Gewichte, die das kleinste Detail lassen</translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the same with weights of any sign; can be unstable</source>
    <translation>dasselbe mit Gewichten beliebigen Vorzeichens; kann instabil sein</translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>half the mean detail of the odd neighbours, by their prediction weights</source>
    <translation>die Hälfte des mittleren Details der ungeraden Nachbarn, nach ihren Vorhersagegewichten</translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>keeps the mean of each removed vertex's ring</source>
    <translation>erhält das Mittel des Rings jedes entfernten Punkts</translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>keeps the weighted mean height at every level</source>
    <translation>erhält die gewichtete mittlere Höhe in jeder Stufe</translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>the vertices that stay keep their heights (subsampling)</source>
    <translation>die Punkte, die bleiben, behalten ihre Höhen (Unterabtastung)</translation>
  </message>
  <message>
    <location filename="../../SIGNALS"/>
    <source>all coordinates, as in the paper; coarse faces may be flipped in plan</source>
    <translation>alle Koordinaten, wie im Artikel; grobe Dreiecke können in der Ebene umklappen</translation>
  </message>
  <message>
    <location filename="../../SIGNALS"/>
    <source>elevation and attributes; every level is a valid TIN</source>
    <translation>Höhe und Attribute; jede Stufe ist ein gültiges TIN</translation>
  </message>
  <message>
    <location filename="../../QUADRICS"/>
    <source>built anew on every level</source>
    <translation>auf jeder Stufe neu gebildet</translation>
  </message>
  <message>
    <location filename="../../QUADRICS"/>
    <source>built on the input, handed on (Eqs. 52-53)</source>
    <translation>auf der Eingabe gebildet und weitergereicht (Gl. 52-53)</translation>
  </message>
  <message>
    <location filename="../../COSTS"/>
    <source>the least of them, which is that of the collapse</source>
    <translation>die kleinste davon, die der Kollaps selbst hat</translation>
  </message>
  <message>
    <location filename="../../COSTS"/>
    <source>the sum over the neighbours' quadrics (Eq. 36)</source>
    <translation>die Summe über die Quadriken der Nachbarn (Gl. 36)</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D printers</source>
    <translation>3D-Drucker</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D software</source>
    <translation>3D-Software</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D viewers, web pages</source>
    <translation>3D-Betrachter, Webseiten</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>CAD</source>
    <translation>CAD</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>CAD, machine control</source>
    <translation>CAD, Maschinensteuerung</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>QGIS (as a mesh layer), D-Flow FM, xugrid</source>
    <translation>QGIS (als Netzlayer), D-Flow FM, xugrid</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>QGIS (as a mesh layer), hydraulic models</source>
    <translation>QGIS (als Netzlayer), hydraulische Modelle</translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>TELEMAC, QGIS (as a mesh layer)</source>
    <translation>TELEMAC, QGIS (als Netzlayer)</translation>
  </message>
</context>
</TS>

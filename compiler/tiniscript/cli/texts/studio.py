"""The sentences of `tsc` about the studio, in English and Spanish."""

from __future__ import annotations

# fmt: off
STUDIO_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "studio_not_built": ("tsc: the studio's page is not in this installation. In a clone of the repository  tsc studio  builds it; a wheel that is made after that has it, and its users need nothing more.",
                         "tsc: la página del estudio no está en esta instalación. En un clon del repositorio,  tsc studio  la construye; un wheel hecho después la trae, y quien lo usa no necesita nada más."),
    "studio_missing": ("The studio's page is not in this clone yet, and can be built here.",
                       "La página del estudio todavía no está en este clon, y se puede construir aquí."),
    "studio_stale": ("The studio's page was built from other sources than those of this clone. To build it again:  {how}",
                     "La página del estudio se construyó con otras fuentes, no con las de este clon. Para construirla de nuevo:  {how}"),
    "studio_no_node": ("tsc: the studio's page is not in this clone yet, and it is built with node.js {oldest} or newer and its npm, which are not on this computer. Install them from nodejs.org, or:  {how}   and run the command again.",
                       "tsc: la página del estudio todavía no está en este clon, y se construye con node.js {oldest} o posterior y su npm, que no están en esta computadora. Instálalos desde nodejs.org, o:  {how}   y repite el comando."),
    "studio_types": ("checking the page's sources", "revisando las fuentes de la página"),
    "studio_packing": ("packing Python for the browser", "empaquetando Python para el navegador"),
    "studio_bundling": ("putting the page together", "armando la página"),
    "studio_taken": ("tsc: the port {port} cannot be used: {why}. Is another tsc studio running? Then open {address}. Or choose another with --listen: what a browser keeps of your work belongs to the port.",
                     "tsc: no se puede usar el puerto {port}: {why}. ¿Hay otro tsc studio? Entonces abre {address}. O elige otro con --listen: el navegador guarda tu trabajo por separado para cada puerto."),
    "studio_here": ("TiniScript Studio is at {address}   The line above opens it with your robots, once: then another follows. Ctrl-C ends.",
                    "TiniScript Studio está en {address}   La línea de arriba lo abre con tus robots una sola vez; después sale otra. Ctrl-C termina."),
    "studio_opened": ("That address has been opened. To open the studio with your robots again:",
                      "Esa dirección ya se abrió. Para abrir otra vez el estudio con tus robots:"),
    "studio_class": ("The class is at {address}   Code: {code}   Pupils open that address and type the code. The line above is only for you, and opens once: with it you see and stop everything. Ctrl-C ends.",
                     "La clase está en {address}   Código: {code}   Los alumnos abren esa dirección y escriben el código. La línea de arriba es solo para ti y se abre una sola vez: con ella ves y detienes todo. Ctrl-C termina."),
    "studio_no_network": ("tsc: this computer is in no network that pupils could reach. Join the WiFi of the room, or name this computer's address with --address.",
                          "tsc: esta computadora no está en ninguna red a la que lleguen los alumnos. Conéctala al WiFi del aula, o indica su dirección con --address."),
    "studio_no_address": ("tsc: the class cannot be at {address}: {why}. Is another tsc studio running? Otherwise choose another port with --listen, or an address that this computer has with --address.",
                          "tsc: la clase no puede estar en {address}: {why}. ¿Hay otro tsc studio? Si no, elige otro puerto con --listen, o una dirección que tenga esta computadora con --address."),
    "studio_bad_address": ("tsc: --address takes an address of this computer in the room's network, such as 192.168.1.5, not {found}.",
                           "tsc: --address acepta una dirección de esta computadora en la red del aula, como 192.168.1.5, no {found}."),
    "studio_needs_class": ("tsc: --address, --port and --turn are for a class. Add --class.",
                           "tsc: --address, --port y --turn son para una clase. Agrega --class."),
}

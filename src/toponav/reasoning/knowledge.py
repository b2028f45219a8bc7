"""Common knowledge of homes: which rooms there are and what stands in them.

Written by hand, once, from everyday experience, and not fitted to any house, data set or result: it
says what a person would say. `affinity` turns it into numbers. Names are canonical
(`toponav.categories`); a word in no table is handled there as well.
"""

from __future__ import annotations

from dataclasses import dataclass

USUAL = 0.8
"""Probability that a room of the type holds what it usually holds."""

OFTEN = 0.4
"""Probability of what it often holds."""

SOMETIMES = 0.15
"""Probability of what it holds now and then."""

RARE = 0.02
"""Probability of everything else: homes are odd, and detectors err."""


@dataclass(frozen=True)
class RoomContents:
    """What a type of room holds, as canonical names separated by spaces.

    Attributes:
        frequency: Rooms of this type in an ordinary home; relative, they need not sum to 1.
        usual: Present in most of them.
        often: Present in many.
        sometimes: Present in some.
    """

    frequency: float
    usual: str
    often: str
    sometimes: str


ROOMS = {
    "bedroom": RoomContents(
        2.5,
        usual="bed cushion nightstand wardrobe lamp picture",
        often="chest_of_drawers clothes mirror rug curtain chair blanket box book",
        sometimes="tv_monitor desk plant tv_stand bench stool seating sofa laptop shoe_rack "
        "cabinet table bookshelf phone clock refuse_bin suitcase backpack fireplace gym_equipment",
    ),
    "kids room": RoomContents(
        0.4,
        usual="bed toy cushion picture",
        often="desk chair bookshelf book chest_of_drawers wardrobe clothes lamp rug teddy_bear box "
        "curtain nightstand crib blanket",
        sometimes="tv_monitor laptop backpack ball mirror cabinet stool plant table piano clock",
    ),
    "bathroom": RoomContents(
        2.0,
        usual="toilet sink mirror towel toilet_paper soap",
        often="shower bathtub cabinet counter refuse_bin toothbrush rug",
        sometimes="picture plant washing_machine dryer hair_dryer stool lamp curtain clothes scale",
    ),
    "kitchen": RoomContents(
        1.0,
        usual="oven fridge sink counter cabinet microwave",
        often="dishwasher refuse_bin stool chair table kettle toaster coffee_maker cup bowl bottle "
        "pan knife fruit",
        sometimes="plant picture seating washing_machine clock towel rug lamp tv_monitor dryer "
        "bench bookshelf",
    ),
    "dining room": RoomContents(
        0.7,
        usual="table chair picture",
        often="cabinet plant lamp rug seating vase bottle cup curtain",
        sometimes="bench mirror fireplace stool tv_monitor bookshelf bowl clock chest_of_drawers "
        "candle counter piano",
    ),
    "living room": RoomContents(
        1.2,
        usual="sofa cushion tv_monitor coffee_table picture rug lamp",
        often="chair tv_stand plant table bookshelf book seating fireplace curtain vase remote "
        "cabinet blanket",
        sometimes="piano stool chest_of_drawers mirror clock bench game_console speaker guitar "
        "candle stairs laptop box bottle toy desk",
    ),
    "office": RoomContents(
        0.6,
        usual="desk chair laptop book",
        often="bookshelf tv_monitor lamp picture printer keyboard computer_mouse refuse_bin "
        "cabinet box plant rug computer",
        sometimes="sofa table seating chest_of_drawers stool clock phone cushion piano backpack "
        "gym_equipment",
    ),
    "hallway": RoomContents(
        1.5,
        usual="picture",
        often="stairs rug mirror lamp",
        sometimes="plant table cabinet bench chair shoe_rack clothes chest_of_drawers bookshelf "
        "clock",
    ),
    "entryway": RoomContents(
        0.5,
        usual="shoe_rack",
        often="clothes bench mirror rug picture umbrella cabinet",
        sometimes="stairs plant lamp stool backpack table chair chest_of_drawers seating bicycle",
    ),
    "laundry room": RoomContents(
        0.4,
        usual="washing_machine dryer",
        often="sink cabinet clothes counter detergent laundry_basket iron",
        sometimes="box towel refuse_bin ironing_board broom vacuum_cleaner shoe_rack mirror",
    ),
    "utility room": RoomContents(
        0.3,
        usual="box",
        often="water_heater cabinet broom vacuum_cleaner washing_machine tool bookshelf",
        sometimes="dryer sink workbench refuse_bin bicycle iron ironing_board ladder fridge",
    ),
    "closet": RoomContents(
        0.7,
        usual="clothes",
        often="wardrobe shoe_rack box chest_of_drawers suitcase",
        sometimes="mirror towel stool lamp bookshelf vacuum_cleaner rug",
    ),
    "garage": RoomContents(
        0.4,
        usual="car box",
        often="workbench bicycle tool ladder bookshelf refuse_bin",
        sometimes="cabinet washing_machine dryer gym_equipment fridge stairs water_heater chair "
        "bench table ball",
    ),
    "gym": RoomContents(
        0.15,
        usual="gym_equipment",
        often="mirror tv_monitor bench towel ball",
        sometimes="rug plant fridge clock speaker picture stool",
    ),
    "library": RoomContents(
        0.15,
        usual="bookshelf book chair",
        often="desk table lamp rug sofa seating picture",
        sometimes="piano fireplace plant cushion laptop stairs coffee_table clock",
    ),
}
"""What a home's rooms hold; the order is that of every array over rooms."""

ROOM_SYNONYMS = {
    "bath": "bathroom",
    "closet room": "closet",
    "corridor": "hallway",
    "den": "living room",
    "dining area": "dining room",
    "dining": "dining room",
    "dressing room": "closet",
    "entrance": "entryway",
    "entrance hall": "entryway",
    "ensuite": "bathroom",
    "family room": "living room",
    "fitness room": "gym",
    "foyer": "entryway",
    "guest room": "bedroom",
    "gym room": "gym",
    "hall": "hallway",
    "home office": "office",
    "kid room": "kids room",
    "kids bedroom": "kids room",
    "children room": "kids room",
    "nursery": "kids room",
    "kitchenette": "kitchen",
    "landing": "hallway",
    "laundry": "laundry room",
    "lavatory": "bathroom",
    "living": "living room",
    "living area": "living room",
    "lobby": "entryway",
    "lounge": "living room",
    "mudroom": "entryway",
    "powder room": "bathroom",
    "restroom": "bathroom",
    "storage": "utility room",
    "storage room": "utility room",
    "study": "office",
    "study room": "office",
    "toilet": "bathroom",
    "tv room": "living room",
    "utility": "utility room",
    "walk in closet": "closet",
    "washroom": "bathroom",
    "wc": "bathroom",
    "workout room": "gym",
    "workshop": "garage",
}
"""Other words for the types of ROOMS, as models and data sets use them."""

COMPANIONS = {
    "bed": "nightstand cushion blanket lamp",
    "tv_monitor": "tv_stand remote sofa game_console",
    "sofa": "coffee_table cushion tv_stand",
    "desk": "laptop chair printer keyboard computer computer_mouse",
    "table": "chair seating",
    "toilet": "toilet_paper sink shower bathtub",
    "sink": "soap mirror towel toothbrush counter dishwasher",
    "towel": "shower bathtub sink",
    "shower": "bathtub",
    "fridge": "oven counter microwave dishwasher",
    "oven": "counter microwave pan kettle",
    "counter": "stool dishwasher microwave",
    "washing_machine": "dryer detergent laundry_basket",
    "wardrobe": "clothes",
    "bookshelf": "book",
    "chest_of_drawers": "mirror clothes",
    "shoe_rack": "clothes",
    "workbench": "tool",
    "car": "workbench bicycle",
}
"""Pairs that stand side by side, not only in the same room; read both ways."""

CUE_WORDS = {
    "kitchen": "coffee tea cooking cook kettle toaster pot pan food spice dish dishes plate "
    "cutlery fork spoon blender mixer bread wine stove hob freezer juice egg pantry",
    "bathroom": "bath shower toothbrush toothpaste shampoo soap razor hygiene toilet tissue hair "
    "bathing",
    "bedroom": "sleeping bedside bedding mattress pajamas duvet alarm",
    "kids room": "kid kids child children baby toy doll lego crib bunk cradle",
    "living room": "tv television gaming game sofa couch remote stereo",
    "dining room": "dining dinner",
    "office": "office computer printer printing stapler paper document keyboard desk work",
    "laundry room": "laundry washing ironing detergent drying",
    "garage": "tool tools car bike bicycle motorcycle drill hammer saw wrench",
    "gym": "exercise fitness yoga dumbbell treadmill weights workout",
    "closet": "clothing hanger coat dress",
    "entryway": "shoe shoes boot boots umbrella key keys doormat",
    "utility room": "cleaning vacuum broom mop boiler heater storage",
    "library": "reading",
}
"""Words of a free-text target that point to a room even when the thing itself is unknown."""
